import pickle

from uq.errors import InputError, nearest


def test_an_input_error_prints_one_line_per_fault():
    error = InputError("a: first", "a: second")
    assert error.lines == ("a: first", "a: second")
    assert str(error) == "a: first\na: second"


def test_an_input_error_survives_the_way_back_from_a_worker():
    assert pickle.loads(pickle.dumps(InputError("a", "b"))).lines == ("a", "b")


def test_nearest_names_the_likely_choice_whatever_the_case():
    choices = ["contact_stiffness", "contact_area"]
    assert nearest("Contact_stifness", choices) == "; did you mean 'contact_stiffness'?"


def test_nearest_keeps_silent_when_nothing_is_near():
    assert nearest("zzz", ["contact_stiffness"]) == ""
