"""The papers that the algorithms come from, as the reference list of Bekaert, Cools and Willems has them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Citation:
    """One publication.

    Attributes:
        key, kind: key and kind of its BibTeX entry.
        fields: name and value of each field, author, title and year among them.
    """

    key: str
    kind: str
    fields: tuple[tuple[str, str], ...]

    @property
    def bibtex(self) -> str:
        """The BibTeX entry."""
        return f"@{self.kind}{{{self.key},\n" + "".join(f"  {name} = {{{value}}},\n" for name, value in self.fields) + "}"

    @property
    def text(self) -> str:
        """The citation as one line of text."""
        fields = dict(self.fields)
        where = fields.get("journal") or fields.get("booktitle") or fields.get("school") or ""
        numbers = ", ".join(
            part
            for part in (
                fields.get("volume", "") + (f"({fields['number']})" if "number" in fields else ""),
                fields.get("pages", "").replace("--", "-"),
                fields["year"],
            )
            if part
        )
        return f"{fields['author'].replace(' and ', ', ')}. {fields['title']}. {where}, {numbers}."


def _cite(key: str, kind: str, **fields: str) -> Citation:
    return Citation(key, kind, tuple(fields.items()))


WORKSHOP = "Eurographics Workshop on Rendering"

CITATIONS = {
    citation.key: citation
    for citation in (
        _cite(
            "bekaert1996",
            "inproceedings",
            author="Philippe Bekaert and Yves D. Willems",
            title="Error control for radiosity",
            booktitle=f"Rendering Techniques '96 (Seventh {WORKSHOP})",
            pages="153--164",
            year="1996",
            month="June",
        ),
        _cite(
            "bekaert1999",
            "phdthesis",
            author="Philippe Bekaert",
            title="Hierarchical and stochastic algorithms for radiosity",
            school="Katholieke Universiteit Leuven",
            year="1999",
        ),
        _cite(
            "cohen1985",
            "article",
            author="Michael F. Cohen and Donald P. Greenberg",
            title="The hemi-cube: A radiosity solution for complex environments",
            journal="Computer Graphics (SIGGRAPH '85)",
            volume="19",
            number="3",
            pages="31--40",
            year="1985",
            month="August",
        ),
        _cite(
            "cohen1988",
            "article",
            author="Michael F. Cohen and Shenchang Eric Chen and John R. Wallace and Donald P. Greenberg",
            title="A progressive refinement approach to fast radiosity image generation",
            journal="Computer Graphics (SIGGRAPH '88)",
            volume="22",
            number="4",
            pages="75--84",
            year="1988",
            month="August",
        ),
        _cite(
            "feda1993",
            "inproceedings",
            author="Martin Feda and Werner Purgathofer",
            title="Progressive ray refinement for Monte Carlo radiosity",
            booktitle=f"Fourth {WORKSHOP}",
            pages="15--26",
            year="1993",
            month="June",
        ),
        _cite(
            "goral1984",
            "article",
            author="Cindy M. Goral and Kenneth E. Torrance and Donald P. Greenberg and Bennett Battaile",
            title="Modeling the interaction of light between diffuse surfaces",
            journal="Computer Graphics (SIGGRAPH '84)",
            volume="18",
            number="3",
            pages="213--222",
            year="1984",
            month="July",
        ),
        _cite(
            "hanrahan1991",
            "article",
            author="Pat Hanrahan and David Salzman and Larry Aupperle",
            title="A rapid hierarchical radiosity algorithm",
            journal="Computer Graphics (SIGGRAPH '91)",
            volume="25",
            number="4",
            pages="197--206",
            year="1991",
            month="July",
        ),
        _cite(
            "keller1996",
            "inproceedings",
            author="Alexander Keller",
            title="Quasi-Monte Carlo radiosity",
            booktitle=f"Rendering Techniques '96 (Seventh {WORKSHOP})",
            pages="101--110",
            year="1996",
            month="June",
        ),
        _cite(
            "neumann1995",
            "article",
            author="L{\\'a}szl{\\'o} Neumann",
            title="Monte Carlo radiosity",
            journal="Computing",
            volume="55",
            number="1",
            pages="23--42",
            year="1995",
        ),
        _cite(
            "neumann1995ray",
            "inproceedings",
            author="L{\\'a}szl{\\'o} Neumann and Werner Purgathofer and Robert F. Tobler and Attila Neumann "
            "and Pavol Eli{\\'a}{\\v{s}} and Martin Feda and Xavier Pueyo",
            title="The stochastic ray method for radiosity",
            booktitle=f"Rendering Techniques '95 (Sixth {WORKSHOP})",
            year="1995",
            month="July",
        ),
        _cite(
            "neumann1997",
            "article",
            author="L{\\'a}szl{\\'o} Neumann and Attila Neumann and Philippe Bekaert",
            title="Radiosity with well distributed ray sets",
            journal="Computer Graphics Forum",
            volume="16",
            number="3",
            year="1997",
        ),
        _cite(
            "pattanaik1992",
            "inproceedings",
            author="Sumanta N. Pattanaik and Sudhir P. Mudur",
            title="Computation of global illumination by Monte Carlo simulation of the particle model of light",
            booktitle=f"Third {WORKSHOP}",
            pages="71--83",
            year="1992",
            month="May",
        ),
        _cite(
            "sbert1993",
            "article",
            author="Mateu Sbert",
            title="An integral geometry based method for fast form-factor computation",
            journal="Computer Graphics Forum",
            volume="12",
            number="3",
            pages="C409--C420",
            year="1993",
        ),
        _cite(
            "sbert1996",
            "article",
            author="Mateu Sbert and Xavier Pueyo and L{\\'a}szl{\\'o} Neumann and Werner Purgathofer",
            title="Global multipath Monte Carlo algorithms for radiosity",
            journal="The Visual Computer",
            volume="12",
            number="2",
            pages="47--61",
            year="1996",
        ),
        _cite(
            "sbert1997",
            "article",
            author="Mateu Sbert",
            title="Error and complexity of random walk Monte Carlo radiosity",
            journal="IEEE Transactions on Visualization and Computer Graphics",
            volume="3",
            number="1",
            pages="23--38",
            year="1997",
            month="March",
        ),
        _cite(
            "shirley1991",
            "incollection",
            author="Peter Shirley",
            title="Radiosity via ray tracing",
            booktitle="Graphics Gems II",
            editor="James Arvo",
            publisher="Academic Press",
            pages="306--310",
            year="1991",
        ),
        _cite(
            "walter1997",
            "article",
            author="Bruce Walter and Philip M. Hubbard and Peter Shirley and Donald P. Greenberg",
            title="Global illumination using local linear density estimation",
            journal="ACM Transactions on Graphics",
            volume="16",
            number="3",
            pages="217--259",
            year="1997",
            month="July",
        ),
    )
}
