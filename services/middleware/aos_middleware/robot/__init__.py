"""The robot as the middleware knows it: who serves its paths, what moves, what is silent, stops of calls."""
