"""The sentences that tests pin, in one table: who mends a wording changes this file alone.

Other tests assert facts: the exit code, the key or row that is named, the value.
"""

from math import inf, nan, pi

from uq.indices.methods import METHODS, designs_for
from uq.sampling.designs import DESIGNS
from uq.sampling.laws import LAWS

UNIFORM = {"distribution": "uniform", "lower": -pi, "upper": pi}
BOUNDS = f"{-pi!r} to {pi!r} [1]"

# changes of a study file -> the one line, or what it contains
STUDY_FAULTS = [
    # tables and keys
    ({"study": {"name": None}}, "[study] name: is missing"),
    ({"design": {"samples": None}}, "[design] samples: is missing"),
    (
        {"study": {"modle": "x"}},
        "[study] modle = \"x\": no such key; did you mean 'model'?"
        " (allowed: name, model, description)",
    ),
    (
        {"desing": {"seed": 1}},
        "[desing]: no such table; did you mean 'design'?"
        " (allowed: study, design, fixed, uncertain,"
        " dependence, settings, analysis, data)",
    ),
    # what is missing because it is misspelt is reported once
    (
        {"design": {"samples": None, "sampels": 8}},
        "[design] sampels = 8: no such key; did you mean",
    ),
    (
        {"uncertain": {"x3": {"distribution": "uniform", "lower": 0.0, "uper": 4.0}}},
        "[uncertain.x3] uper = 4.0: no such argument of x3's law; did you mean 'upper'?",
    ),
    (
        {"uncertain": {"x3": {"distrbution": "uniform", "lower": 0.0, "upper": 4.0}}},
        "[uncertain.x3] distrbution = \"uniform\": no such key; did you mean 'distribution'?",
    ),
    (
        {"analysis": {"tolerance": {"coverage": 0.95, "confidenc": 0.95}}},
        "[analysis] tolerance.confidenc = 0.95: no such key; did you mean 'confidence'?",
    ),
    (
        {"study": {"name": "a/b"}},
        "[study] name = \"a/b\": must consist of letters, digits, '-' and '_'",
    ),
    ({"study": {"name": "n" * 101}}, "must have at most 100 characters"),
    ({"study": {"description": 3}}, "[study] description = 3: must be a text in quotes"),
    # the model
    (
        {"study": {"model": "ishigmi"}},
        "[study] model = \"ishigmi\": no such model 'ishigmi'; did you mean 'ishigami'?",
    ),
    (
        {"study": {"model": "models.analytic:LINEAR"}},
        "must consist of letters, digits, '-' and '_'",
    ),
    # the design
    (
        {"design": {"method": "monte_carlo"}},
        "[design] method = \"monte_carlo\": no such design; did you mean 'monte-carlo'?"
        f" (allowed: {', '.join(DESIGNS)})",
    ),
    (
        {"design": {"method": "saltelli", "samples": 1000}},
        "[design] samples = 1000: must be a power of two, 512 or 1024, for 'saltelli'",
    ),
    (
        {"design": {"method": "sobol", "samples": 1000}},
        "[design] samples = 1000: must be a power of two, 512 or 1024, for 'sobol'",
    ),
    ({"design": {"samples": 0}}, "[design] samples = 0: must be at least 1"),
    ({"design": {"samples": 2**31}}, "[design] samples = 2147483648: must be at most 1073741824"),
    (
        {"design": {"samples": 8.0}},
        "[design] samples = 8.0: must be a whole number, without a decimal point",
    ),
    ({"design": {"samples": True}}, "[design] samples = true: must be a whole number"),
    ({"design": {"samples": "8"}}, '[design] samples = "8": must be a whole number'),
    ({"design": {"replicates": 0}}, "[design] replicates = 0: must be at least 1"),
    ({"design": {"seed": -1}}, "[design] seed = -1: must be at least 0"),
    ({"design": {"second_order": 1}}, "[design] second_order = 1: must be true or false"),
    (
        {"design": {"second_order": True}},
        "[design] second_order = true: only for method = 'saltelli'",
    ),
    # fixed parameters
    (
        {"fixed": {"zebra": 1.0}},
        "[fixed] zebra = 1.0: no such parameter of model 'ishigami' (allowed: x1, x2, x3)",
    ),
    (
        {"fixed": {"x1": 1.0}},
        "[uncertain.x1]: is in [fixed] too; keep one of the two",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": -5.0}},
        f"[fixed] x3 = -5.0: must be within {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": True}},
        "[fixed] x3 = true: must be a number",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": nan}},
        f"[fixed] x3 = nan: must be within {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": None}, "fixed": {"x3": -inf}},
        f"[fixed] x3 = -inf: must be within {BOUNDS}",
    ),
    # laws
    (
        {"uncertain": {"x33": UNIFORM}},
        "[uncertain.x33]: no such parameter of model 'ishigami'; did you mean 'x3'?",
    ),
    ({"uncertain": {"x3": 1.0}}, "uncertain.x3 = 1.0: must be a table"),
    (
        {"uncertain": {"x3": {"lower": 0, "upper": 1}}},
        f"[uncertain.x3] distribution: is missing (allowed: {', '.join(LAWS)}",
    ),
    (
        {"uncertain": {"x3": {"distribution": "unifrom", "lower": 0, "upper": 1}}},
        "[uncertain.x3] distribution = \"unifrom\": no such law; did you mean 'uniform'?",
    ),
    (
        {"uncertain": {"x3": {"distribution": "uniform", "lower": 0}}},
        "[uncertain.x3] upper: is missing",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "meen": 1}}},
        "[uncertain.x3] meen = 1: no such argument of x3's law"
        " (allowed: source, distribution, lower, upper, truncate, times, level)",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": "0"}}},
        '[uncertain.x3] lower = "0": must be a number',
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": inf}}},
        "[uncertain.x3] lower = inf: must be a finite number",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": 2, "upper": 1}}},
        "[uncertain.x3]: must have lower < upper: lower = 2.0, upper = 1.0",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 0, "sd": -0.1}}},
        "[uncertain.x3] sd = -0.1: must be greater than 0",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 4, "sd": 0.1}}},
        f"[uncertain.x3] mean = 4.0: must be within the parameter's bounds, {BOUNDS}",
    ),
    (
        {"uncertain": {"x3": {"distribution": "normal", "mean": 0, "sd": 1}}},
        f"[uncertain.x3]: has 0.0017 of its probability outside the parameter's bounds, {BOUNDS}"
        " (allowed: 1e-06); use a truncated-normal with lower and upper within them,"
        " or other numbers",
    ),
    (
        {"uncertain": {"x3": {**UNIFORM, "lower": 0, "upper": 4}}},
        f"[uncertain.x3]: has 0.21 of its probability outside the parameter's bounds, {BOUNDS}"
        " (allowed: 1e-06); lower = 0.0 and upper = 4.0 must be within them",
    ),
    (
        {"uncertain": {"x1": None, "x2": None, "x3": None}},
        "[uncertain]: nothing varies; give at least one parameter a law",
    ),
    # settings
    (
        {"settings": {"depths": [1.25e-4, 2.5e-4]}},
        "[settings] depths = [0.000125, 0.00025]: no such setting of model 'ishigami',"
        " which has none",
    ),
    # analysis
    (
        {"analysis": {"outputs": ["z"]}},
        "[analysis] outputs = \"z\": no such output of model 'ishigami' (allowed: y)",
    ),
    ({"analysis": {"outputs": "y"}}, '[analysis] outputs = "y": must be a list'),
    ({"analysis": {"outputs": ["y", "y"]}}, '"y" is listed twice'),
    ({"analysis": {"quantiles": [0.5, 1.0]}}, "[analysis] quantiles[1] = 1.0: must be less than 1"),
    (
        {"analysis": {"quantiles": [0, 0.5]}},
        "[analysis] quantiles[0] = 0: must be greater than 0",
    ),
    ({"analysis": {"quantiles": 0.5}}, "[analysis] quantiles = 0.5: must be a list"),
    ({"analysis": {"max_failed": 1.5}}, "[analysis] max_failed = 1.5: must be at most 1"),
    (
        {"analysis": {"thresholds": {"z": 1.0}}},
        "[analysis] thresholds.z = 1.0: no such output of model 'ishigami' (allowed: y)",
    ),
    (
        {"analysis": {"thresholds": {"y": "1"}}},
        '[analysis] thresholds.y = "1": must be a number or a list of numbers',
    ),
    ({"analysis": {"tolerance": 0.95}}, "[analysis] tolerance = 0.95: must be a table, such as"),
    (
        {"analysis": {"tolerance": {"coverage": 0.95}}},
        "[analysis] tolerance.confidence: is missing",
    ),
    (
        {"analysis": {"tolerance": {"coverage": 0.95, "confidence": 95}}},
        "[analysis] tolerance.confidence = 95: must be at most 0.999999999",
    ),
    (
        {
            "design": {"method": "saltelli"},
            "analysis": {"tolerance": {"coverage": 0.95, "confidence": 0.95}},
        },
        "[analysis] tolerance = {coverage = 0.95, confidence = 0.95}: refused: its confidence"
        " assumes independent rows, and those of 'saltelli' are not; use method = 'monte-carlo',"
        " or leave the bound out",
    ),
    (
        {"analysis": {"sensitivity": ["sobl"]}},
        "[analysis] sensitivity[0] = \"sobl\": no such method; did you mean 'sobol'?"
        f" (allowed: {', '.join(METHODS)})",
    ),
    (
        {"analysis": {"sensitivity": ["sobol"]}},
        "[analysis] sensitivity = \"sobol\": a 'monte-carlo' design cannot feed it,"
        " method = 'saltelli' can; 'monte-carlo' feeds 'first-order' or 'rbd-fast' or 'delta'",
    ),
    (
        {"design": {"method": "saltelli"}, "analysis": {"sensitivity": ["delta"]}},
        f"method = {' or '.join(map(repr, designs_for('delta')))} can",
    ),
]


# text of a study file -> what its one line contains
SYNTAX_FAULTS = [
    ("[study\n", "not valid TOML: Expected ']' at the end of a table declaration (at line 1"),
    ("[study]\nname = \n", "Invalid value (at line 2, column 8)"),
    ("[study]\n[study]\n", "Cannot declare ('study',) twice (at line 2, column 7)"),
    ('[study]\nname = "a"\nname = "b"\n', "Cannot overwrite a value (at line 3"),
    ("a = [-inf, 1e400]", "not valid TOML: 1e400 is too large for a number"),
    ("a = " + "[" * 5000, "not valid TOML: "),
    ("a = 1" + "0" * 5000, "not valid TOML: "),
]

# arguments of uq -> how the one line begins
MISTAKES = {
    "sumary": "uq: No such command 'sumary'. Did you mean 'summary'? See 'uq --help'",
    "run": "uq: Missing argument 'STUDY'; see 'uq run --help'",
    "run a.toml --sampels 3": "uq: No such option: --sampels; did you mean '--samples'?",
    "run a.toml --workers -1": "uq: Invalid value for '--workers': ",
    "run a.toml --samples many": "uq: Invalid value for '--samples': ",
    "run absent.toml": "absent.toml: no such file",
    "run .": ".: is a directory",
    "run broken.toml": "broken.toml: not valid TOML: ",
    "run small.toml --model nowhere:M": "model 'nowhere:M' cannot be imported",
    "run small.toml -o folder": "folder: is a folder; give the name of a file in it",
    "run small.toml -o /proc/x.nc": "/proc/x.nc: cannot write in /proc: ",
    "run small.toml -o broken.toml": "broken.toml: not a readable netCDF file; ",
    "run small.toml --workers 1 --scheduler tcp://x:1": "workers and scheduler exclude each other",
    "simulate ishigamy": "no such model 'ishigamy'; did you mean 'ishigami'?",
    "simulate linear --set x1": "--set x1: write it as NAME=VALUE with a number",
    "simulate linear --set x1=-1e400": (
        "--set x1=-1e400: -1e400 is too large for a number; write it as inf if infinity is meant\n"
    ),
    "simulate beam --setting horizon=1e400": "--setting horizon=1e400: 1e400 is too large",
    "simulate linear --set x1=much": "--set x1=much: write it as NAME=VALUE with a number",
    "simulate linear --set x1=nan": "x1 = nan: ",
    "simulate linear --set x1=inf": "x1 = inf: must be within 0.0 to 1.0 [1]",
    "simulate sample_models:MOUNTED --set mount_stiffness=1e3": (
        "mount_stiffness = 1000.0: must be within 10000.0 to inf [N m-1]"
    ),
    "simulate linear --set x5=1": "x5 = 1.0: no such parameter of model 'linear'",
    "simulate linear --setting fail_how": "--setting fail_how: write it as NAME=VALUE",
    "simulate linear --setting fail_how=3": "setting fail_how = 3: must be one of nan, inf",
    "simulate vibrator --setting body_points=[[1.0,0.2,0.3]]": (
        "setting body_points = [[1.0, 0.2, 0.3]]: must be a list, each a list of 2, each a number "
        "within -30.0 to 30.0 [m]\n"
    ),
    "simulate linear --plot f.png": "model 'linear' gives no trajectory",
    "simulate sample_models:KINDS -o folder": "folder: is a folder",
    "simulate sample_models:KINDS --plot /proc/f.png": "/proc/f.png: cannot write in /proc: ",
    "simulate sample_models:KINDS --plot f.xyz": "f.xyz: Format 'xyz' is not supported",
    "models nothing": "no such model 'nothing'",
    "init nothing": "no such model 'nothing'",
    "check absent.toml": "absent.toml: no such file",
    "summary absent.nc": "absent.nc: no such file",
    "row absent.nc 3": "absent.nc: no such file",
    "row absent.nc many": "uq: Invalid value for 'N': ",
    "row absent.nc --near-quantile 0.05": "uq: Option '--near-quantile' requires 2 arguments",
    "summary small.toml": (
        "small.toml: is a study, not a result; 'uq run small.toml' computes its result"
    ),
    "sensitivity folder": "folder: is a folder, not a result",
    "plot absent.nc": "absent.nc: no such file",
}


# Sentences that several verbs print
SENTENCES = {
    # of a run, and of rows kept
    "compiling": "compiling the model (once; it may take a minute)",
    "done": "{output}: {done} of {rows} rows were already done\n",
    "damaged": "{rows}: {count} rows are damaged and will be computed again\n",
    "interrupted": (
        "interrupted after {done} of {rows} rows, kept in {place}; the same command resumes the "
        "run\n"
    ),
    "nothing written": "interrupted; nothing was written",
    "resumes": "the same command resumes the run\n",
    "unwritten": "{place}: could not be written: {why}",
    "too many failed": "rows are invalid, more than max_failed = {share} allows ({status}: row ",
    # of other rows, other code, other processes
    "another study": (
        "{rows}: has rows of another study ({change}); choose another output, or start over with "
        "--fresh\n"
    ),
    "fewer": "{rows}: has rows of this study with more ({change}); ",
    "other code": "has rows from other code of model '{model}'",
    "other code refused": (
        "{output}: has rows from other code of model '{model}' with the same version; "
        "start over with uq run --fresh, or continue with --mixed\n"
    ),
    "other code shown": (
        "{output}: has rows from other code of model '{model}'; 'uq verify' compares "
        "them with the code here, 'uq run --fresh' computes all of them again\n"
    ),
    "another model": (
        "{output}: was computed with another model (version {old} of model '{model}', now {new}); "
        "rerun the study, into another output or with --fresh\n"
    ),
    "other versions": "{output}: some rows were computed with {package} {old} (here {new})\n",
    "in use": "{rows}: in use by process {pid} on {host}\n",
    "in use elsewhere": (
        "{rows}: in use by process {pid} on {host}; if that has ended, remove {lock}\n"
    ),
    "in use by nobody": "{rows}: in use by another process; if there is none, remove {lock}\n",
    "cannot be extended": (
        "a '{design}' design cannot be extended: all its rows change with their number; run it "
        "again, into another output or with --fresh\n"
    ),
    # of results
    "no file": "{name}: no such file",
    "no fewer samples": "no estimates from fewer samples",
    "size": "must be a power of two, {least} or {next},",
}


def sentence(key, **values):
    """Return a sentence of the table with its values."""
    return SENTENCES[key].format(**values)
