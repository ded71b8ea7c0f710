"""What is written in a figure."""


def words(figure):
    """Return everything that is written in a figure."""
    texts = [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text"))]
    return " ".join(" ".join(texts).split())
