# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and tables as HTML."""
import math
import string
from html import escape

DASH = "–"


def number(value, digits=3):
    """Significant digits, thin spaces between thousands, powers of ten beyond them; a dash for what is not a number."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return DASH
    if isinstance(value, int) and abs(value) < 10**9:
        return f"{value:,}".replace(",", " ").replace("-", "−")
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not -5 < exponent < 7:
        mantissa = f"{value / 10.0**exponent:.{digits - 1}f}".replace("-", "−")
        return f"{mantissa} × 10<sup>{str(exponent).replace('-', '−')}</sup>"
    decimals = max(0, digits - 1 - exponent)
    return f"{value:,.{decimals}f}".replace(",", " ").replace("-", "−")


def quantity(value, unit, digits=3):
    """A number with its unit."""
    text = number(value, digits)
    return text if text == DASH or not unit else f"{text} {unit}"


def height_decimals(relief):
    """Decimals with which the heights of a terrain are written, all alike: three digits of its relief."""
    return max(0, min(3, 2 - math.floor(math.log10(relief)))) if relief and relief > 0 else 0


def fixed(value, decimals):
    """A number with so many decimals."""
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return DASH
    return f"{value:,.{decimals}f}".replace(",", " ").replace("-", "−")


def plain(value):
    """A number that was given, as it was given."""
    return f"{value:g}".replace("-", "−") if isinstance(value, (int, float)) else DASH


def interval(pair, digits=3):
    """A 95 % interval in brackets, or nothing."""
    if not isinstance(pair, (list, tuple)) or len(pair) != 2 or None in pair:
        return ""
    return f"[{number(pair[0], digits)}, {number(pair[1], digits)}]"


def show(value, digits=3):
    """Any JSON value in a table's cell."""
    if value is None:
        return DASH
    if isinstance(value, (bool, int, float)):
        return number(value, digits)
    if isinstance(value, dict):
        return ", ".join(f"{escape(str(key))} {show(each, digits)}" for key, each in value.items())
    if isinstance(value, list):
        return ", ".join(show(each, digits) for each in value)
    return escape(str(value))


class Footnotes:
    """Reasons for missing numbers, lettered in the order they are met."""

    def __init__(self):
        self.reasons = []

    def mark(self, reason):
        """A raised letter for the reason (the same letter for the same reason); nothing where none is known."""
        if not reason:
            return ""
        if reason not in self.reasons:
            self.reasons.append(reason)
        return f"<sup>{self._letter(self.reasons.index(reason))}</sup>"

    def html(self):
        if not self.reasons:
            return ""
        notes = "; ".join(f"<sup>{self._letter(i)}</sup> {escape(reason)}" for i, reason in enumerate(self.reasons))
        return f'<p class="footnotes">{notes}</p>'

    @staticmethod
    def _letter(index):
        letters = string.ascii_lowercase
        return letters[index % 26] * (1 + index // 26)


def table(head, rows, css=""):
    """Rows of HTML cells; a row of one cell is a heading over the rows that follow."""
    titles = "".join(f'<th scope="col">{cell}</th>' for cell in head)
    lines = [f'<div class="scroll"><table class="{css}">', f"<thead><tr>{titles}</tr></thead>" if any(head) else "",
             "<tbody>"]
    for row in rows:
        if len(row) == 1:
            lines.append(f'<tr class="group"><th scope="colgroup" colspan="{len(head)}">{row[0]}</th></tr>')
        else:
            lines.append(f'<tr><th scope="row">{row[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in row[1:]) + "</tr>")
    lines.append("</tbody></table></div>")
    return "".join(lines)
