#!/usr/bin/env python3
"""Counts words that docs/style.md advises against, in comments (C++ and Python), in the messages of the program (string literals of src/), and in the
pages (README.md, CONTRIBUTING.md, docs/, without code and without what scripts write).
No count may exceed its ceiling in english_ceilings.txt, and a ceiling may only fall: new text follows the style, old text is mended bit by bit.

Truth: the ceilings. The checker checks itself on text with known counts first.

usage: check_english.py ROOT [--list NAME | --lower]
  --list NAME   prints each line that counts for NAME
  --lower       writes counts that have fallen as the new ceilings
"""
import io
import re
import sys
import tokenize
from pathlib import Path

KINDS = ("comments", "messages", "pages")
CEILINGS = Path(__file__).with_name("english_ceilings.txt")
MEASURES = "axis|beam|bin|block|byte|case|cell|channel|class|column|core|direction|file|group|hemisphere|hour|level|line|metre|minute|mutant|object|octant|"
MEASURES += "ordinate|part|pixel|point|process|processor|ray|row|run|second|segment|side|step|sweep|thread|tile|voxel|wavelength"
VERBS = r"(?:is|was|has|as|sees|does|ends|takes|crosses|becomes|gives|makes|needs|holds|starts|reads|writes)\b"

# Name: what counts, and what to write. Patterns are for one comment or one literal, its lines joined.
WORDS = {
    "where": (r"\bwhere\b", "if or when; where is for places"),
    "what-begins": (r"(?:^|[.:] )What\b(?![^.]*\?)", "the subject itself"),
    "a-for-per": (rf"(?:\bone|\beach|%|\b(?!{VERBS})\w+s|\[[^\]]*\]) an? (?:{MEASURES})\b", "per"),
    "tell": (r"\b(?:tells?|told|telling)\b", "returns, prints, is reported"),
    "know": (r"\b(?:knows?|knew|knowing)\b", "has, reads, includes"),
    "metaphor": (r"\b(?:strangers?|deaths?|dies|confess\w*|goodness|makes? good|asks? for all|ways? out|at home)\b", "the plain term"),
    "befall": (r"\b(?:befalls?|besides|thereof|hereby|likewise|for ever|lives? on)\b", "a plain word, or nothing"),
    "long-sentence": (None, "sentences of at most 20 words"),
    # Names that docs/style.md replaces; in comments and messages only, code follows by renaming.
    "wishes": (r"\bwish(?:es)?\b", "settings"),
    "rehearsal": (r"\brehears\w*", "reads in a sandbox"),
    "surroundings": (r"\bsurroundings?\b", "lateral boundary"),
    "halves": (r"\bhalves\b", "float16, or half of"),
    "forecast": (r"\bforecasts?\b", "cost estimate"),
    "left-out-axes": (r"\bleft_out_axes\b|\bleft out axes\b", "collapsed axes"),
    "last-gather": (r"\blast gather\b", "final gather"),
}
LONGEST_SENTENCE = 20  # words
GENERATED = ("commands.md", "python-api.md")  # from help texts and docstrings, which are read in the sources

CPP = re.compile(r"""(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<literal>(?:R"(?P<mark>\w*)\(.*?\)(?P=mark)")|"(?:\\.|[^"\\\n])*")|'(?:\\.|[^'\\\n])'""", re.DOTALL)


def joined(parts):
    """(line, text) of neighbouring lines, one after another without other text between, as one text each."""
    texts, last = [], None
    for line, text in parts:
        if last is not None and line == last + 1:
            texts[-1] = (texts[-1][0], f"{texts[-1][1]} {text}")
        else:
            texts.append((line, text))
        last = line
    return texts


def cpp_texts(text):
    """Comments and literals of a C++ source, each with the number of its first line. A remark behind code stands for itself."""
    comments, remarks, literals = [], [], []
    for token in CPP.finditer(text):
        line = text.count("\n", 0, token.start()) + 1
        before = text[text.rfind("\n", 0, token.start()) + 1:token.start()].strip()
        if token["comment"]:
            words = re.sub(r"^(?://+<?|/\*+<?)|\*/$", "", token["comment"]).strip()
            (remarks if before else comments).append((line, words))
        elif token["literal"] and "#include" not in before:
            literals.append((line, token["literal"].strip('"')))
    return joined(comments) + remarks, joined(literals)


def python_texts(text):
    comments, docstrings = [], []
    previous = None
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith("#!"):
            comments.append((token.start[0], token.string.lstrip("# ")))
        elif token.type == tokenize.STRING and previous in (None, tokenize.INDENT, tokenize.NEWLINE, tokenize.NL, tokenize.DEDENT):
            # Blank lines and lines below headings end a sentence.
            docstrings.append((token.start[0], " ".join(re.sub(r"\n\s*(-{3,}\s*)?\n", " ; ", token.string.strip('"')).split())))
        if token.type != tokenize.COMMENT:
            previous = token.type
    return joined(comments) + docstrings


def page_texts(text):
    """Paragraphs, headings, items of lists and cells of tables of a page, without code, equations, addresses and figures that scripts write."""
    text = re.sub(r"<!-- begin ([\w-]+) -->.*?<!-- end \1 -->|^```.*?^```|^\$\$.*?^\$\$", lambda block: "\n" * block.group().count("\n"), text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"`[^`\n]*`|\$[^$\n]+\$", "x", re.sub(r"\]\([^)\n]*\)", "]", text))
    found = []
    for line, words in enumerate(text.splitlines(), 1):
        if not words.strip() or re.match(r"\s*(\||#|[-*] |\d+\. )", words):
            found += [(line, cell) for cell in words.split("|") if re.search(r"[^\W\d_]", cell)] + [None]
        elif found and found[-1] is not None:
            found[-1] = (found[-1][0], f"{found[-1][1]} {words.strip()}")
        else:
            found.append((line, words.strip()))
        # A line of text below an item belongs to it.
        if found and found[-1] is None and re.match(r"\s*([-*] |\d+\. )", words) and len(found) > 1:
            found.pop()
    return [part for part in found if part is not None]


def long_sentences(text):
    return [sentence for sentence in re.split(r"(?<=[.;:?!])\s+", text) if len(re.findall(r"[^\W\d_][\w'-]*", sentence)) > LONGEST_SENTENCE]


def found_in(name, text):
    pattern = WORDS[name][0]
    return long_sentences(text) if pattern is None else re.findall(pattern, text, re.IGNORECASE if name != "what-begins" else 0)


def texts_of(root):
    """(kind, place, text) of all comments and messages."""
    for path in sorted(path for folder in ("include", "python", "src", "tests", "scripts", "docs") for path in (root / folder).rglob("*")):
        place = path.relative_to(root)
        if path.resolve() == Path(__file__).resolve() or path.suffix not in (".cpp", ".hpp", ".py"):
            continue
        if path.suffix == ".py":
            comments, messages = python_texts(path.read_text()), []
        else:
            comments, messages = cpp_texts(path.read_text())
        for line, text in comments:
            yield "comments", f"{place}:{line}", text
        if place.parts[0] == "src":
            for line, text in messages:
                yield "messages", f"{place}:{line}", text


    pages = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
    for path in (page for page in pages if page.exists() and page.name not in GENERATED):
        for line, text in page_texts(path.read_text()):
            yield "pages", f"{path.relative_to(root)}:{line}", text


def counts_of(texts):
    counts = {(name, kind): 0 for name in WORDS for kind in KINDS}
    for kind, _, text in texts:
        for name in WORDS:
            counts[name, kind] += len(found_in(name, text))
    return counts


def read_ceilings():
    rows = [line.split() for line in CEILINGS.read_text().splitlines() if line and not line.startswith("#")]
    return {(name, kind): int(count) for name, *numbers in rows for kind, count in zip(KINDS, numbers)}


def write_ceilings(ceilings):
    head = "# Counts that check_english.py allows: name, in comments, in messages, in pages. They may only fall (check_english.py ROOT --lower).\n"
    CEILINGS.write_text(head + "".join(f"{name:15} {ceilings[name, 'comments']:5} {ceilings[name, 'messages']:5} {ceilings[name, 'pages']:5}\n" for name in WORDS))


def check_the_checker():
    comments, literals = cpp_texts('#include "where.hpp"\n// One place where\n// it rains.\nf("where \\" a");  // What is told\nint a = 1\'000;\n')
    assert comments == [(2, "One place where it rains."), (4, "What is told")], comments
    assert literals == [(4, 'where \\" a')], literals
    assert python_texts('"""Where."""\na = "where"  # told\n') == [(2, "told"), (1, "Where.")]
    page = "# A\n\nOne\ntwo `where` [three](where.md).\n- four\n  five\n\n| a | told |\n\n```\nwhere\n```\n<!-- begin t -->\nwhere\n<!-- end t -->\n"
    assert [text.strip() for _, text in page_texts(page)] == ["# A", "One two x [three].", "- four five", "a", "told"], page_texts(page)
    assert len(found_in("what-begins", "What is told. What for? So what")) == 1
    assert len(found_in("a-for-per", "8 directions a hemisphere, one a thread; has a voxel, is a file")) == 2
    assert found_in("long-sentence", "word " * 20 + "end.") and not found_in("long-sentence", "word " * 10 + "end. " + "word " * 15)


def main():
    check_the_checker()
    root, *options = Path(sys.argv[1]), *sys.argv[2:]
    texts = list(texts_of(root))
    if options[:1] == ["--list"]:
        for kind, place, text in texts:
            if found_in(options[1], text):
                print(f"{place}: {kind}: {text}")
        return 0
    counts = counts_of(texts)
    ceilings = read_ceilings() if CEILINGS.exists() else counts
    if options[:1] == ["--lower"]:
        write_ceilings({key: min(count, ceilings.get(key, count)) for key, count in counts.items()})
        return 0
    above = [(key, count) for key, count in counts.items() if count > ceilings.get(key, 0)]
    for (name, kind), count in above:
        print(f"\"{name}\" in {kind}: {count}, allowed {ceilings.get((name, kind), 0)} (better: {WORDS[name][1]}; check_english.py . --list {name})")
    fallen = sum(count < ceilings.get(key, 0) for key, count in counts.items())
    print(f"{len(texts)} comments and messages, {len(above)} counts above their ceilings, {fallen} below (--lower makes them the new ceilings)")
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
