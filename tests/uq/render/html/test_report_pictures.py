"""The pictures of a report: small, sharp, and only where there is something to draw."""

import re

import numpy as np
from computed import (
    asking,
    kinds,
    linear,
    with_output,
)
from matplotlib.figure import Figure
from read_pages import Page, read

from uq.assess.findings import Findings
from uq.render.html.page import page
from uq.render.html.pictures import HEAVIEST_SVG, picture, pictures, shortened
from uq.result.result import Result

BY_REGIME = 'aria-label="Shares of the regimes over the inputs that best separate them"'


def test_a_study_about_the_regimes_is_headed_by_their_shares_over_the_inputs():
    def headed(outputs):
        text = page(Result(kinds(samples=96, analysis={"outputs": outputs})), "OUT.nc")
        assert text.count(BY_REGIME) == 1
        return BY_REGIME in text[text.index('id="answer"') : text.index('id="explore"')]

    assert headed(["regime", "work"]) and not headed(["work", "regime"])


def test_a_staircase_takes_few_characters_and_keeps_its_place():
    path = "M 10 20.004 L 10.25 20 L 10.25 19.83 L 11 19 z M 0 0 L -0.5 0.12"
    assert shortened(path) == "M10 20h.25v-.17l.75-.83zM0 0l-.5 .12"
    rng = np.random.default_rng(1)
    places = np.round(rng.uniform(-50, 300, (200, 2)), 6)
    places[1::2, 0] = places[::2, 0]
    drawn = shortened("M " + " \nL ".join(f"{x} {y}" for x, y in places))
    here, points = np.zeros(2), []
    for kind, numbers in re.findall("([Mhvl])([^Mhvl]+)", drawn):
        step = [float(number) for number in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers)]
        step = {"h": [*step, 0.0], "v": [0.0, *step]}.get(kind, step)
        here = np.array(step) if kind == "M" else here + step
        points.append(here)
    assert np.abs(np.array(points) - places).max() < 0.0051
    assert shortened("M 0 0 C 1 2 3 4 5 6") == "M 0 0 C 1 2 3 4 5 6"


def test_a_life_curve_of_many_rows_is_no_image():
    ds = with_output(linear(samples=4000), "life", np.linspace(1, 9, 4000) ** 3, "lifetime")
    drawn = next(
        picture_of_life
        for picture_of_life in pictures(Findings(Result(asking(ds, outputs=["life"]))), "results")
    )
    assert drawn.subject == "life" and not drawn.is_image and len(drawn.html) < 100_000


def test_a_crowded_figure_becomes_an_image():
    figure = Figure(figsize=(3.4, 2.0))
    rng = np.random.default_rng(1)
    figure.subplots().plot(*rng.normal(size=(2, 100_000)), ".")
    drawn = picture(figure, 'a "cloud"')
    assert drawn.is_image and len(drawn.html) < HEAVIEST_SVG
    assert dict(Page(drawn.html).attributes)["alt"] == 'a "cloud"'


def test_points_that_are_drawn_as_an_image_leave_the_text_of_their_figure_sharp():
    figure = Figure(figsize=(3.4, 3.4))
    x, y, colour = np.random.default_rng(1).uniform(size=(3, 20_000))
    figure.subplots().scatter(x, y, c=colour, s=4, lw=0, rasterized=True)
    drawn = picture(figure, "many points")
    assert not drawn.is_image and len(drawn.html) > HEAVIEST_SVG and "<text" in drawn.html


def test_of_an_output_without_any_value_nothing_is_drawn():
    ds = linear(samples=32, settings={"fail_above": -1.0})
    parsed = read(ds)
    assert "Invalid rows: 32" in parsed.plain_words
    assert parsed.tags.count("figure") == 1  # of the inputs
