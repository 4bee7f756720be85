import instructions


def test_only_what_grew_by_more_than_the_limit_is_bad(capsys):
    baseline = {"a": 1000, "b": 1000, "c": 1000}
    assert instructions.grown({"a": 1019, "b": 1021, "c": 900}, baseline, 2.0) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [("GREW" in line) for line in lines] == [False, True, False]


def test_every_hot_scene_has_a_size():
    for name in instructions.HOT:
        text = (instructions.ROOT / "references" / "scenes" / f"{name}.xml").read_text(encoding="utf-8")
        assert 'name="res"' in text, name
