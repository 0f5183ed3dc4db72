"""The order of children: sequences, choices, repetitions, and any order."""

from __future__ import annotations

from scenario_compiler.structure.content import AnyOrder, Choice, Content, Name, Repeat, Sequence


def test_content_models() -> None:
    a, b, c = (Name(tag, tag) for tag in "abc")
    content = Content.of(Sequence((a, Repeat(Choice((b, c)), 0, None), Repeat(a, 2, 3))))

    def accepts(tags: str) -> bool:
        state = content.start
        for tag in tags:
            state = content.move(state, tag)
        return content.complete(state)

    assert [tags for tags in ("a", "aaa", "abcbaa", "aaaa", "aaaaa", "aba", "aa", "") if accepts(tags)] == [
        *("aaa", "abcbaa", "aaaa"),
    ]
    after = content.move(content.start, "a")
    assert content.missing(after, None) is not None
    assert content.missing(after, None)[0] == ["a", "a"]  # type: ignore[index]
    assert content.missing(content.start, "b") == (["a"], content.move(after, "b"))


def test_children_in_any_order() -> None:
    content = AnyOrder.of_parts([(Name("a", "x"), True), (Name("b", "b"), False), (Name("c", "c"), True)])
    state = content.move(content.start, "c")
    assert content.declaration("a") == "x"
    assert not content.move(state, "c")
    assert not content.complete(state)
    assert content.missing(state, "b") is None or content.move(state, "b")
    assert content.missing(state, None) == (["a"], content.move(state, "a"))
    assert content.complete(content.move(state, "a"))
    assert content.expected(state) == ["a", "b"]
    assert content.fits_sorted(["c", "a"])
    assert not content.fits_sorted(["c", "b"])


def test_what_is_missing_is_named_with_what_could_stand_in_its_place() -> None:
    a, b, c, d = (Name(tag, tag) for tag in "abcd")
    content = Content.of(Sequence((Choice((a, b, Sequence((c, d)))), Repeat(c, 0, 1), Choice((d, b)))))
    assert content.choices(content.start, None) == [["a", "b"], ["b", "d"]]
    assert content.choices(content.move(content.start, "c"), None) == [["d"], ["b", "d"]]
    assert content.choices(content.start, "d") == [["a", "b", "c"]]
    any_order = AnyOrder.of_parts([(Name(tag, tag), True) for tag in "ab"])
    assert any_order.choices(any_order.start, None) == [["a"], ["b"]]
