"""The cache folder of a user without a home."""

import os
import pwd
from unittest.mock import patch

from uq.places import cache_path


def test_without_a_home_no_folder_is_made_in_the_current_one(folder, monkeypatch):
    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    with patch.object(pwd, "getpwuid", side_effect=KeyError):
        path = cache_path("vibrolife")
    assert path.is_absolute() and not path.exists()
    assert os.listdir(folder) == []
