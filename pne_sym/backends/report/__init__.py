"""The report back end: the derivation as a document that people read."""

from __future__ import annotations

from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.report import functions, legs, mechanism, words
from pne_sym.backends.report.collected import collect
from pne_sym.backends.report.equations import ChapterWriter, index_rows
from pne_sym.backends.report.given import GivenWriter
from pne_sym.backends.report.markdown import escape, inline, table
from pne_sym.backends.report.names import printer_for
from pne_sym.backends.report.overview import overview
from pne_sym.backends.templating import render
from pne_sym.derivation import Law


class ReportBackend:
    """Emits NAME.md."""

    operations = None

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        return {f"{bundle.name}.md": render("report/report.md.jinja", report=contents(bundle))}


def contents(bundle: Bundle) -> dict[str, Any]:
    """What the template prints."""
    derivation = bundle.derivation
    printer = printer_for(derivation)
    given = GivenWriter(derivation, printer)
    collected = collect(derivation)
    chapters = ChapterWriter(bundle, collected).chapters()
    used_laws = {e.law for e in derivation.equations()}
    used_laws |= {Law(r.law) for r in derivation.relations}
    return {
        "name": bundle.name,
        "title": escape(bundle.manipulator.title),
        "summary": mechanism.summary(bundle),
        "cases": mechanism.cases(bundle),
        "sizes": mechanism.sizes(bundle),
        "orders": mechanism.orders(bundle),
        "equation": mechanism.equation_of_motion(bundle),
        "contents": tuple(f"[{c.title}](#{c.anchor})" for c in chapters),
        "conventions": words.CONVENTIONS,
        "marks": table(("Notation", "Meaning"), [(inline(a), b) for a, b in words.MARKS]),
        "laws": table(
            ("Law", "What it says"),
            [(law.value, text) for law, text in words.LAWS.items() if law in used_laws],
        ),
        "frames": given.frames(None),
        "notation": given.table(None),
        "parameters": legs.parameter_table(derivation),
        "places": legs.places(derivation),
        "overview": tuple(overview(bundle, collected, printer)),
        "legs": legs.leg_views(bundle, given),
        "chapters": chapters,
        "functions": tuple(functions.function_statements(bundle, printer)),
        "failures": functions.failures(bundle),
        "counts": functions.counts(bundle),
        "parts": functions.parts(bundle),
        "index": table(
            ("Symbol", "Meaning", "Unit", "Equation"),
            index_rows(derivation, printer, collected),
        ),
    }
