"""One number for one quantity: in the tiles, causes and tables of a page, its card and its JSON."""

import html
import json
import re
from pathlib import Path
from unittest.mock import patch

import pytest
from computed import summarised
from explored import cells, drag_handle

import uq as api
from uq.assess.answer.answer import conclude
from uq.assess.card import card_of
from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.card import card
from uq.render.html.dossier.chapters import dossier
from uq.render.html.page import page
from uq.render.trace.trace import traced
from uq.result.result import Result

STUDIES = Path(__file__).parents[4] / "studies"
SHIPPED = ["exponential-wear", pytest.param("ishigami", marks=pytest.mark.slow)]


@pytest.fixture(scope="module", params=SHIPPED)
def shipped(request, tmp_path_factory):
    """Return a result of a shipped study, its card and its page."""
    folder = tmp_path_factory.mktemp("shipped")
    ds = api.run(STUDIES / f"{request.param}.toml", folder / "out.nc")
    with patch.dict(FIGURES, clear=True):  # puts them back in their order
        return ds, card_of(Findings(Result(ds))), page(Result(ds), "out.nc")


def shown_numbers(text):
    """Return what a page shows for each key: texts of tiles, values of the cells of tables."""
    start = r'<(?:div|td|dd)[^>]*data-trace="[^"]+"[^>]*>'
    tags = re.findall(rf'{start}.*?(?=</?(?:div class="tile"|td|dd|tr))', text, re.DOTALL)
    numbers = {}
    for tag in tags:
        head, _, inside = tag.partition(">")
        (keys,) = re.findall(r'data-trace="([^"]+)"', head)
        value = re.search(r'data-key="([^"]+)"', head)
        tile = re.search(r'class="tile-value">(.*?)<', inside) or re.match(r"\s*<b>(.*?)<", inside)
        for key in html.unescape(keys).split("\n"):
            shown = float(value[1]) if value else html.unescape(tile[1]) if tile else None
            if shown is not None:
                numbers.setdefault(key, set()).add(shown)
    return numbers


def spaced(text):
    """Return text with plain spaces."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def rounded_alike(text, value, unit):
    """Return whether a text shows a number to its digits, in its unit or in per cent."""
    plain = spaced(text).replace("\N{MINUS SIGN}", "-")
    number = float(re.match(r"-?[\d.]+", plain)[0])
    scale = 100.0 if "%" in plain else 1 / {"s": 86400.0}.get(unit, 1.0)
    return number == pytest.approx(value * scale, rel=0.02, abs=0.06 if "%" in plain else 0.0)


def test_tiles_show_the_numbers_of_the_card(shipped):
    ds, of_result, text = shipped
    numbers = shown_numbers(text)
    headline = of_result.json["headline"]
    assert len(headline) > 3 and {entry["key"] for entry in headline} <= set(numbers)
    for entry in headline:
        if entry["value"] is not None:
            shown = [number for number in numbers[entry["key"]] if isinstance(number, str)]
            assert len(shown) == 1 and rounded_alike(shown[0], entry["value"], entry["unit"])
            assert traced(Result(ds), entry["key"]).numbers["value"] == entry["value"]
            assert spaced(shown[0]) in spaced(str(card(ds)))


def test_a_key_has_one_value_and_a_label_one_number(shipped):
    _, of_result, text = shipped
    for key, values in shown_numbers(text).items():
        assert len({value for value in values if isinstance(value, float)}) < 2, key
    labels = re.findall(r'class="tile-label">(.*?)<', text)
    assert len(labels) == len(set(labels)) <= 4
    assert len({entry["label"] for entry in of_result.json["headline"]}) == len(of_result.headline)


def test_the_card_has_the_numbers_of_the_tables(shipped):
    ds, of_result, _ = shipped
    outputs = summarised(ds)["outputs"]
    for entry in of_result.json["headline"]:
        name = re.search(r"(?:quantities|outputs)/([^/]+)/", entry["key"])[1]
        table = outputs[name]
        if entry["label"] == "median":
            assert entry["value"] == table["quantiles"]["0.5"]["value"]
        elif "/promise/" in entry["key"] and "quantile" not in entry["label"]:
            assert entry["value"] == table["tolerance"][entry["key"].rpartition("/")[2]]
        elif "/events/" in entry["key"]:
            ((_, sides),) = table["thresholds"].items()
            assert entry["value"] in (sides["below"]["value"], sides["above"]["value"])


def test_causes_have_the_shares_of_the_sensitivity_table(shipped):
    _, of_result, text = shipped
    numbers = shown_numbers(text)
    assert of_result.json["causes"]
    for cause in of_result.json["causes"]:
        tables = [key for key in numbers if re.search(rf"/(S1|ST)/{cause['input']}$", key)]
        assert tables and any(numbers[key] == {cause["share"]} for key in tables)
        (shown,) = [key for key in numbers if key.endswith(f"/inputs/{cause['input']}")]
        assert numbers[shown] == {cause["share"]}


@pytest.fixture(scope="module")
def wear(tmp_path_factory):
    """Return a result with a life that an assumed input only scales."""
    folder = tmp_path_factory.mktemp("wear")
    return api.run(STUDIES / "exponential-wear.toml", folder / "out.nc")


def test_rows_that_are_not_chosen_have_the_probability_of_the_answer(shown, wear):
    browser = shown(wear)
    (entry,) = [e for e in card_of(Findings(Result(wear))).json["headline"] if e["unit"] == "1"]
    key = f"life/{4 * 86400}"
    head = f"document.querySelector('#explore tr[data-key=\"{key}\"] th').innerText"
    ((value, low, high),) = cells(browser)[key]
    assert (value, low, high) == (entry["value"], entry["low"], entry["high"])
    assert "counted" not in browser.value(head)
    drag_handle(browser, "rate", 1, 250)
    assert len(cells(browser)[key]) == 2 and "counted" in browser.value(head)


WARNING = "Not a prediction: depth sets the scale and is assumed"


def test_what_is_assumed_stands_beside_the_number_wherever_it_is(wear, no_other_figures):
    conclusions = conclude(Findings(Result(wear)))
    notebook = conclusions._repr_html_()
    assert notebook.index('answer-promise">') < notebook.index(WARNING) < notebook.index("90")
    of_page = page(Result(wear), "out.nc")
    tile = of_page[of_page.index('class="main-tile"') :].partition(
        'class="tile-label">Fail within'
    )[0]
    assert WARNING in tile and "<details" not in tile
    assert of_page.count(WARNING) == 3  # tile, sentences, tables of the life
    assert dossier(Result(wear), "out.nc").count(WARNING) >= 2
    assert json.dumps(card_of(Findings(Result(wear))).json).count("not a prediction") == 1
