"""What is said about one output."""

import json

from computed import summarised


def described(ds, name="y"):
    """Return what is said about one element; JSON without any number that is not finite."""
    return json.loads(json.dumps(summarised(ds), allow_nan=False))["outputs"][name]
