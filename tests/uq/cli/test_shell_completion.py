"""What a shell completes when somebody presses the tabulator."""

from pathlib import Path

import pytest

from uq.execution import runner

LAW = 'distribution = "lognormal", median = 2.5e-10, sigma = 0.5'


@pytest.fixture
def a_study_and_its_result(folder, write_study):
    """Put a study and its result where people keep them."""
    path = write_study("exponential-wear", samples=16, uncertain=["rate"], law=LAW)
    for name in ("studies", "results", "elsewhere"):
        (folder / name).mkdir()
    study = Path(path).rename(folder / "studies" / "wear.toml")
    runner.run(study, folder / "results" / "wear.nc", workers=0)
    return study


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("uq rep", ["report"]),
        ("uq run --sam", ["--samples"]),
        ("uq models be", ["beam"]),
        ("uq simulate expo", ["exponential-wear"]),
        ("uq init nothing", []),
        ("uq check ", ["studies/wear.toml"]),
        ("uq run st", ["studies/wear.toml"]),
        ("uq run ./studies/w", ["./studies/wear.toml"]),
        ("uq run {folder}/studies/w", ["{folder}/studies/wear.toml"]),
        ("uq run elsewhere/", []),
        ("uq init --from s", ["studies/wear.toml"]),
        ("uq init --from studies/wear.toml --design sal", ["saltelli"]),
        ("uq rare-event studies/wear.toml --output ", ["life"]),
        ("uq summary r", ["results/wear.nc"]),
        ("uq compare results/wear.nc results/", ["results/wear.nc"]),
        ("uq update results/w", ["results/wear.nc"]),
        ("uq sensitivity results/wear.nc --method sob", ["sobol"]),
        ("uq sensitivity results/wear.nc --output l", ["life"]),
        ("uq sensitivity missing.nc --output l", []),
        ("uq plot results/wear.nc --only hist", ["histogram"]),
        ("uq plot results/wear.nc --format s", ["svg"]),
        ("uq what-if results/wear.nc --set uncertain.rate.s", ["uncertain.rate.sigma="]),
        ("uq what-if missing.nc --set unc", []),
        (
            "uq trace results/wear.nc outputs/life/mean_",
            [
                "outputs/life/mean_interval",
                "outputs/life/mean_interval/low",
                "outputs/life/mean_interval/high",
            ],
        ),
        ("uq trace results/wear.nc inputs/rate/stated/0.9", ["inputs/rate/stated/0.95"]),
        ("uq trace missing.nc outputs/l", []),
    ],
)
def test_a_shell_completes(uq, folder, a_study_and_its_result, monkeypatch, typed, completed):
    typed = typed.format(folder=folder)
    completed = [word.format(folder=folder) for word in completed]
    monkeypatch.setenv("_UQ_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - (not typed.endswith(" "))))
    ended = uq()
    assert (ended.code, ended.out.split(), ended.err) == (0, completed, "")
    monkeypatch.setenv("_UQ_COMPLETE", "source_bash")
    assert "complete -o default -F _uq_completion uq" in uq().out
