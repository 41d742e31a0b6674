"""The way from the text of a model to an executable: compilers, their messages, the cache of builds."""
