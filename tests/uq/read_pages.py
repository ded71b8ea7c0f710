"""Reports to read: the tags, attributes and visible words of a page."""

from html.parser import HTMLParser

from uq.result.result import Result
from uq.render.html.page import page


class Page(HTMLParser):
    """The tags, attributes and visible words of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.words, self.inside = [], [], "", None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        self.inside = tag if tag in ("script", "style") else None
        self.words += "" if tag == "wbr" else " "

    def handle_endtag(self, tag):
        self.inside = None

    def handle_data(self, data):
        self.words += "" if self.inside else data

    @property
    def plain_words(self):
        return " ".join(self.words.split())


def read(ds):
    return Page(page(Result(ds), "OUT.nc"))
