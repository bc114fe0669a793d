"""The language of Stage world files: words, includes, definitions."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.stage.world_file import Entity, read_tokens, read_world_file


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return the root of a world given as a text."""
    monkeypatch.chdir(tmp_path)

    def root_of(text: str) -> Entity:
        Path("a.world").write_text(text, encoding="utf-8")
        return read_world_file(Path("a.world"), "a.world")

    return root_of


def test_properties_are_numbers_texts_or_several_of_them(read):
    root = read('name "x y"  # said\nresolution 0.02\nmodel( pose [ 1 -2.5 +.5 90 ]\n size [1\n2 3] )')
    assert {key: given.values for key, given in root.properties.items()} == {"name": ("x y",), "resolution": (0.02,)}
    model = root.children[0]
    assert model.properties["pose"].values == (1.0, -2.5, 0.5, 90.0)
    assert model.properties["size"].values == (1.0, 2.0, 3.0)
    assert str(model.properties["size"].place) == "a.world:4"


def test_brackets_belong_to_a_word(read):
    assert list(read("model( block( point[0] [ 0 1 ] ) )").children[0].children[0].properties) == ["point[0]"]


def test_definition_gives_its_properties_and_parts_to_each_use(read):
    root = read(
        "define eye ranger( sensor( samples 3 ) )\n"
        'define bot position( drive "diff" mass 2 eye( pose [1 0 0 0] ) )\n'
        "define fast bot( mass 3 )\n"
        "fast( mass 4 )\nbot()\nfast( eye() )\n"
    )
    fast, bot, two_eyed = root.children
    assert [(use.kind, use.called) for use in root.children] == [
        ("position", "fast"),
        ("position", "bot"),
        ("position", "fast"),
    ]
    assert [use.properties["mass"].values for use in (fast, bot, two_eyed)] == [(4.0,), (2.0,), (3.0,)]
    assert fast.children[0].kind == "ranger"
    assert fast.children[0].children[0].properties["samples"].values == (3.0,)
    assert [len(use.children) for use in (fast, bot, two_eyed)] == [1, 1, 2]


def test_uses_of_a_definition_do_not_share_their_parts(read):
    one, other = read("define bot position( ranger() )\nbot()\nbot()").children
    one.children[0].properties.update(one.properties)
    assert one.children[0] is not other.children[0]


def test_included_files_are_found_from_the_world_file_and_keep_their_own_lines(read, tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "bot.inc").write_text('include "parts/eye.inc"\n\ndefine bot position( eye() mass 1 )\n')
    (tmp_path / "parts" / "eye.inc").write_text("define eye ranger()")
    root = read('include "parts/bot.inc"\nbot()\n')
    assert root.children[0].children[0].kind == "ranger"
    assert str(root.children[0].properties["mass"].place) == "parts/bot.inc:3"
    assert str(root.children[0].place) == "a.world:2"


def test_comments_in_any_encoding_are_passed_over(tmp_path):
    path = tmp_path / "a.world"
    path.write_bytes(b'\xef\xbb\xbf# n\xe3o rodado\r\nname "b"\r\n')
    assert [(token.value, token.place.line) for token in read_tokens(path, "a.world")] == [("name", 2), ("b", 2)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("model(\n pose [0 0 0 0]\n", "a.world:1: model: '(' is never closed"),
        ("model( size [1 1 1 )\n", "a.world:1: size: ')' is neither a number nor a text in quotes"),
        ("model()\n)\n", "a.world:2: ')': no '(' is open here"),
        ("model( [ 1 ] )", "a.world:1: '[': expected a key or the name of a model"),
        ("model( size [nan 1 1] )", "a.world:1: size: 'nan' is neither a number nor a text in quotes"),
        ("resolution 1e-3", "a.world:1: '1e' is not a number in Stage: expected digits, a point and a sign"),
        ("\nresolution", "a.world:2: resolution: the file ends where a value was expected"),
        ("model( size [ 1 1", "a.world:1: size: the file ends where a value was expected"),
        ('name "x\n', "a.world:1: a text has no closing quote"),
        ("name = 3", "a.world:1: unexpected '='"),
        ("\nname \x01", "a.world:2: unexpected character 1"),
        ("define bot\n", "a.world:1: define: expected a name and a kind, such as define pioneer position ( ... )"),
        ("define bot position\nmass 1", "a.world:1: define: expected '(' after 'bot position'"),
        ('\ninclude "no.inc"', "a.world:2: include: there is no file 'no.inc'"),
        ("include robots", 'a.world:1: include: expected a file name in quotes, such as include "robots.inc"'),
        ('\n\ninclude "a.world"', "a.world:3: include: 'a.world' includes itself"),
        ("model(" * 60 + ")" * 60, "a.world:1: model: nested more than 50 levels deep"),
    ],
)
def test_mistake_is_reported_with_its_line(read, text, message):
    with pytest.raises(ScenarioError) as refused:
        read(text)
    assert str(refused.value) == message


def test_loop_of_included_files_is_rejected(read, tmp_path):
    (tmp_path / "b.inc").write_text('\ninclude "c.inc"')
    (tmp_path / "c.inc").write_text('include "b.inc"')
    with pytest.raises(ScenarioError, match=r"^c\.inc:1: include: 'b\.inc' includes itself$"):
        read('include "b.inc"')


def test_included_files_that_multiply_are_rejected(read, tmp_path):
    for i in range(12):
        (tmp_path / f"{i}.inc").write_text(f'include "{i + 1}.inc"\ninclude "{i + 1}.inc"\n')
    (tmp_path / "12.inc").write_text("")
    with pytest.raises(ScenarioError, match="include: more than 200 included files"):
        read('include "0.inc"')


@pytest.mark.slow
def test_definitions_that_multiply_are_rejected(read):
    kinds = "".join(f"define k{i + 1} model( k{i}() k{i}() k{i}() k{i}() )\n" for i in range(12))
    with pytest.raises(ScenarioError, match="more than 100000 models and parts of models"):
        read("define k0 model()\n" + kinds + "k12()")


def test_definitions_nested_too_deeply_are_rejected(read):
    kinds = "".join(f"define k{i + 1} model( k{i}() )\n" for i in range(100))
    with pytest.raises(ScenarioError, match="nested more than 50 levels deep"):
        read("define k0 model()\n" + kinds + "k100()")


def test_definition_of_itself_is_rejected(read):
    with pytest.raises(ScenarioError, match=r"^a\.world:1: k: nested more than 50 levels deep"):
        read("define k k( )\nk()")


def test_long_definitions_that_are_used_often_are_rejected(read):
    long = "define k model( " + "mass 1 " * 1000 + ")\n"
    with pytest.raises(ScenarioError, match="definitions repeat more than 2000000 words and numbers"):
        read(long + "k() " * 1100)


def test_definition_is_resolved_where_it_is_used_and_the_first_one_counts(read):
    """As in worldfile.cc of Stage 4.3: a definition is a range of tokens, and std::map::insert keeps the first."""
    one, two = read(
        "define big box( mass 5 wheel() )\ndefine box model( mass 2 )\ndefine box model( mass 3 color 1 )\n"
        "define wheel ranger()\nbig()\nbox()"
    ).children
    assert (one.kind, one.called, two.kind) == ("model", "big", "model")
    assert [entity.properties["mass"].values for entity in (one, two)] == [(5.0,), (2.0,)]
    assert ([child.kind for child in one.children], "color" in two.properties) == (["ranger"], False)


def test_definition_that_is_not_used_may_be_wrong(read):
    """Stage only looks for its last parenthesis."""
    assert read("define odd model( 3 ( ] ) )\nmodel()").children[0].kind == "model"


def test_missing_world_file_is_reported():
    with pytest.raises(ScenarioError, match=r"^no\.world: there is no such file$"):
        read_world_file(Path("no.world"), "no.world")
