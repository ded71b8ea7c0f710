"""What is written in a figure."""


def words(figure):
    """Return everything that is written in a figure."""
    texts = [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text"))]
    return " ".join(" ".join(texts).split())


def collisions(figure):
    """Return the pairs of texts of a laid-out figure that overlap, and texts that stick out."""
    figure.draw_without_rendering()
    shown = [text for legend in figure.legends for text in legend.get_texts()]
    shown += [*figure.texts, *([figure._suptitle] if figure._suptitle else [])]
    for axes in figure.axes:
        shown += [*axes.texts, axes.title, axes._left_title]
        for panel in (axes, *axes.child_axes):
            if panel.axison:
                for axis in (panel.xaxis, panel.yaxis):
                    shown += [axis.label, *(tick.label1 for tick in axis._update_ticks())]
    boxes = [
        (text.get_text(), text.get_window_extent())
        for text in dict.fromkeys(shown)
        if text.get_visible() and text.get_text().strip()
    ]
    slack = 1.0  # pixel
    overlaps = [
        (label, other)
        for i, (label, a) in enumerate(boxes)
        for other, b in boxes[:i]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > slack and min(a.y1, b.y1) - max(a.y0, b.y0) > slack
    ]
    width, height = figure.bbox.size
    overlaps += [
        (label, "the edge")
        for label, box in boxes
        if box.x0 < -slack or box.y0 < -slack or box.x1 > width + slack or box.y1 > height + slack
    ]
    return overlaps
