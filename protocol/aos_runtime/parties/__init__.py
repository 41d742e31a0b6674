"""The parties of a bus to one another: questions asked until they are answered, states followed."""
