"""Names of elements, however their numbers are written."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import UNIFORM, kinds, study_of
from until_studies import tables

from uq.errors import InputError
from uq.result.elements import named_elements
from uq.text.element_names import place_of

AXES = {"site": np.array(["left", "1e3"]), "instant": np.array([0.5, 3600.0])}


@pytest.mark.parametrize(
    "written", ["instant=3600.0", "instant=3600", "instant=3.6e3", " instant = 3600. "]
)
def test_a_coordinate_may_be_written_in_any_way(written):
    ((name, index, place),) = place_of(f"y[site=left,{written}]", AXES)
    assert name == "y[site=left,instant=3600.0]"
    assert index == (0, 1) and place == {"site": "left", "instant": 3600.0}


@pytest.mark.parametrize("name", ["y[site=left,instant=3601]", "y[instant=3600]", "y", "y[]"])
def test_another_coordinate_is_another_element(name):
    assert place_of(name, AXES) == []


def test_results_and_studies_take_a_coordinate_as_it_is_written():
    ds, name = kinds("saltelli", samples=64, replicates=4), "life[side=left,depth=5e-1]"
    (element,) = named_elements(ds, name)
    assert element.name == "life[side=left,depth=0.5]"
    assert list(sensitivities(ds, None, f"rank({name})")["outputs"]) == [f"rank({element.name})"]
    until = {"output": name, "half_width": 0.1}
    given = tables(until) | {"uncertain": {"x1": UNIFORM, "x2": UNIFORM}}
    assert study_of(given, "sample_models:KINDS").design.until.output == name
    with pytest.raises(InputError, match="no such element"):
        named_elements(ds, "life[side=left,depth=0.51]")
