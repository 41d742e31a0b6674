"""Workers, which run code of documents: a mapping's, a picture's, and the service's side of both."""
