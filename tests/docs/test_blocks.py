"""The blocks of the README and the guide run in order as printed, and quote what is printed.

Only the rows are fewer: at most 64 samples of a study, but for that whose output is quoted.
"""

import re
import webbrowser
from pathlib import Path

import generated
import pytest
import quoted
from matplotlib import pyplot

HOUSE = Path(__file__).parents[2]
FEWER = 64
WHOLE = "exponential-wear.toml"  # takes a second
QUICK = ("running", "studies")
"""Pages of the guide that take a few seconds."""

INSTALL = ("make", "pip", ".", "uq", "#")
PAGES = {name: (HOUSE / name).read_text(encoding="utf-8") for name in quoted.PAGES}
every_page = pytest.mark.parametrize("name", PAGES)
in_turn = pytest.mark.parametrize(
    "name",
    [
        name if Path(name).stem in QUICK else pytest.param(name, marks=pytest.mark.slow)
        for name in PAGES
    ],
)


def fewer(text):
    def cut(match):
        return f"samples = {min(int(match[1]), FEWER)}"

    return re.sub(r"^samples = (\d+)", cut, text, flags=re.MULTILINE)


@every_page
def test_every_command_is_understood(name):
    verbs = generated.commands()
    for block in quoted.blocks(PAGES[name]):
        for words in quoted.commands(block):
            verb, *rest = words
            if verb.startswith("--"):
                continue
            assert verb in verbs, words
            cut = rest.index(">") if ">" in rest else len(rest)
            verbs[verb].make_context(verb, rest[:cut])


@every_page
def test_a_line_of_a_shell_block_runs_installs_or_says_what_it_needs(name):
    for block in quoted.blocks(PAGES[name]):
        for line in block.text.replace("\\\n", " ").splitlines() * (block.language == "sh"):
            assert line.split()[0] in INSTALL, line


@in_turn
@pytest.mark.filterwarnings("default")
def test_the_blocks_of_a_page_run_as_printed(name, uq, folder, monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda address: True)
    (folder / "studies").mkdir()
    for path in (HOUSE / "studies").glob("*.toml"):
        text = path.read_text()
        (folder / "studies" / path.name).write_text(text if path.name == WHOLE else fewer(text))

    def call(arguments):
        ended = uq(*arguments)
        assert ended.code == 0, (arguments, ended.err)
        return fewer(ended.out) if arguments[0] == "init" else ended.out

    for _ in quoted.run(PAGES[name], call):
        pass
    pyplot.close("all")


@pytest.mark.parametrize(
    "name", [name for name, page in PAGES.items() if any(b.quotes for b in quoted.blocks(page))]
)
@pytest.mark.slow
def test_what_a_page_quotes_is_what_is_printed(name):
    for block, printed in quoted.quotes(name):
        texts = block.text, printed
        expected, actual = map(numbers, texts)
        assert expected == pytest.approx(actual, rel=2e-3), "run: python docs/quoted.py"
        first, second = (re.sub(r"\d+(\.\d+)?", "#", text).split() for text in texts)
        assert first == second, "run: python docs/quoted.py"


def numbers(text):
    return [float(number) for number in re.findall(r"\d+(?:\.\d+)?", text)]


def test_what_is_quoted_and_what_is_a_file_is_seen():
    page = (
        "```sh\nuq models > all.txt\nmake run\nuq plan a.toml  # long\n```\n\n"
        "<!-- printed, last paragraph -->\n\n```text\nold\n```\n\nIn `found.csv`:\n\n"
        "```text\na,b\n```\n\nA study:\n\n```toml\n# a.toml\nx = 1\n```\n\n"
        "```sh\n# needs a server\nuq serve beam\n```\n"
    )
    first, *others = quoted.blocks("Text.\n\n" + page)
    assert list(quoted.commands(first)) == [["models", ">", "all.txt"], ["plan", "a.toml"]]
    assert [(block.file, bool(block.quotes)) for block in others] == [
        ("", True),
        ("found.csv", False),
        ("a.toml", False),
        ("", False),
    ]


def test_quotes_are_those_of_the_command_above(folder):
    page = (
        "Text.\n\n```sh\nuq plan a\n```\n\n<!-- printed, last paragraph -->\n\n```text\nold\n```\n"
    )
    calls = []

    def call(arguments):
        calls.append(arguments)
        return "first\n\nsecond\n"

    [(block, printed)] = quoted.run(page, call)
    assert (block.text, printed, calls) == ("old\n", "second\n", [["plan", "a"]])
