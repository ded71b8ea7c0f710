"""Which points of the unit cube a study visits."""
