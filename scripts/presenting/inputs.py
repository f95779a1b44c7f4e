# SPDX-License-Identifier: Apache-2.0
"""Results about verdicts that change because a test's input is stored in float32."""
from presenting.figures import bars
from presenting.records import count, percent, require
from presenting.result import Result

MODELS = {
    "survey": "Surveys, UTM",
    "local": "Surveys, local origin",
    "bore": "Shaft in its bore",
    "part": "Blade and its moved copy",
}


def stored(r):
    pairs = {model: r("stored", f"Pairs of triangles that lie near each other, `{model}`") for model in MODELS}
    table = "Wrong verdicts in float32 on a model of doubles"
    cell = lambda lane, model, what: r("stored", f"{table}, `{lane}/f32`: `{model}`, {what}")
    exact = {model: cell("exact", model, "wrong") for model in MODELS}
    moller = {model: cell("moller_1997", model, "wrong") for model in MODELS}
    for model in MODELS:
        require(exact[model] == cell("exact", model, "by storing"), "exact is wrong by storing alone")
    require(exact["survey"] > 500 * exact["local"], "a local origin makes storing nearly harmless")
    for model in ("bore", "part"):
        require(moller[model] > 20 * exact[model], f"computing errs far more than storing: {model}")
    share = lambda wrong, model: percent(wrong[model], pairs[model])
    rows = []
    for model, label in MODELS.items():
        for wrong, what, kind in ((exact, "stored, decided exactly", "b"), (moller, "moller_1997", "a")):
            rows.append((f"{label}: {what}", 100 * wrong[model] / pairs[model], share(wrong, model), kind))
    alt = (
        f"Share of wrong verdicts on near pairs that are stored in float32: {share(exact, 'survey')} on surveys in "
        f"UTM coordinates, {share(exact, 'local')} with a local origin, {share(exact, 'bore')} on a shaft in its bore, "
        f"{share(exact, 'part')} on a blade and its moved copy; with moller_1997 {share(moller, 'survey')}, "
        f"{share(moller, 'local')}, {share(moller, 'bore')} and {share(moller, 'part')}."
    )
    return Result(
        "stored",
        f"Stored in float32, surveys in map coordinates give another verdict on {share(exact, 'survey')} of their "
        f"near pairs; with a local origin, on {share(exact, 'local')}",
        "What does it cost to store a model of doubles in float32, for example to upload it to a GPU? For "
        "models that lie near each other, we took all pairs of triangles whose boxes overlap, and compared the exact "
        "verdict on the stored triangles with that on the doubles. For surveys of the same ground, in UTM "
        "coordinates, storing changes "
        f"{count(exact['survey'])} of {count(pairs['survey'])} verdicts; a test that decides the stored floats "
        "correctly is wrong on all of these pairs. With the origin at a corner of the area, storing changes only "
        f"{count(exact['local'])} of {count(pairs['local'])} verdicts. On machine parts, computing in float32 with "
        "`moller_1997` costs more than storing. For a shaft in its bore, far from the origin of its assembly, storing "
        "changes "
        f"{count(exact['bore'])} of {count(pairs['bore'])} verdicts, and `moller_1997` is wrong on "
        f"{count(moller['bore'])}. For a turbine blade beside a copy that is moved by a thousandth, storing changes "
        f"{count(exact['part'])} of {count(pairs['part'])}, and `moller_1997` is wrong on {count(moller['part'])}. "
        "`scripts/near_models` generates all models except the blade.",
        bars(alt, "% of pairs of triangles that lie near each other", rows),
        alt,
        main=("stored", f"{table}, `exact/f32`: `survey`, wrong"),
    )
