"""From a study file to a study, or to one line that says what is wrong with it."""
