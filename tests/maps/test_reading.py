import re

import pytest

from maps import PlanError, bundled_names, read_plan


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_plans_are_read_by_name(name):
    plan = read_plan(name)
    assert plan.name == name
    assert plan.source == "bundled"
    assert plan.repairs == ()
    assert plan.start


def test_there_are_a_house_and_an_office():
    assert {"house", "office"} <= set(bundled_names())


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("offce", "There is no file offce and no bundled plan of this name; did you mean 'office'?"),
        ("xyzzy", "no bundled plan of this name; choose one of 'house', 'museum', 'office', 'school'"),
        ("nowhere.geojson", "There is no file nowhere.geojson."),
        ("nowhere/map.yaml", "There is no file nowhere/map.yaml."),
        (".", ". is a folder; a floor plan is a file."),
        ("", "The name of the floor plan is empty."),
        ("a\0b", "There is no file"),
    ],
)
def test_what_is_not_there_is_refused(given, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(PlanError, match=re.escape(sentence)):
        read_plan(given)


def test_an_unknown_kind_of_file_is_refused(tmp_path):
    path = tmp_path / "plan.docx"
    path.write_text("")
    with pytest.raises(PlanError, match=r"files of the kind \.docx cannot be read; readable are "):
        read_plan(path)
    bare = tmp_path / "plan"
    bare.write_text("")
    with pytest.raises(PlanError, match=r"files of the kind \(no suffix\) cannot be read"):
        read_plan(bare)
