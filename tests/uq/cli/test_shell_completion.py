"""What a shell completes when somebody presses the tabulator."""

import pytest


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("uq rep", ["report"]),
        ("uq run --sam", ["--samples"]),
        ("uq models be", ["beam"]),
        ("uq simulate expo", ["exponential-wear"]),
        ("uq init nothing", []),
    ],
)
def test_a_shell_completes_verbs_options_and_models(uq, monkeypatch, typed, completed):
    monkeypatch.setenv("_UQ_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    ended = uq()
    assert (ended.code, ended.out.split(), ended.err) == (0, completed, "")
    monkeypatch.setenv("_UQ_COMPLETE", "source_bash")
    assert "complete -o default -F _uq_completion uq" in uq().out
