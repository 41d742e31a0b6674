"""Problem files of other planners: read into models of numbers, and written from them."""
