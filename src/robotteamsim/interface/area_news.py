"""The messages by which robots that choose their areas share which are explored, and where each goes next."""

import msgspec

from robotteamsim.interface.payload import Index, read_payload, to_payload


class AreaNews(msgspec.Struct, frozen=True):
    """What one robot knows and intends; areas by their indices in `mission.areas`.

    explored: the areas that it knows to be explored, ascending.
    next:     the area to which it goes; None if it goes to none.
    """

    explored: tuple[Index, ...] = ()
    next: Index | None = None


class _Message(msgspec.Struct, frozen=True):
    area_news: AreaNews


_messages = msgspec.json.Decoder(_Message)


def area_news(news: AreaNews) -> str:
    """Return the payload that shares it."""
    return to_payload(_Message(news))


def area_news_in(payload: str) -> AreaNews | None:
    """Return the news in a message; None if it is another message."""
    if '"area_news"' not in payload:
        return None
    found = read_payload(_messages, payload)
    return found.area_news if found else None
