"""Problems whose states cannot be listed, each with a rule by hand as its reference."""
