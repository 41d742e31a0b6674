"""The building of models: from their text to an executable, with compilers, their messages, and the cache
of builds."""
