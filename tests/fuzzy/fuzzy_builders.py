"""Sets, variables and controllers of the bindings, from the mappings that a YAML file holds."""

from pilotfish import fuzzy


def make_set(spec):
    ((shape, p),) = spec.items()
    if shape == "triangle":
        return fuzzy.Triangle(*p)
    return fuzzy.Trapezoid(*p) if shape == "trapezoid" else fuzzy.Gaussian(**p)


def make_controller(data):
    """A controller through the bindings, from the mapping that the YAML file holds."""

    def variable(name):
        terms = [fuzzy.Term(label, make_set(spec)) for label, spec in data[name]["terms"].items()]
        lo, hi = data[name]["universe"]
        return fuzzy.LinguisticVariable(name, terms, min=lo, max=hi)

    error, error_change, output = variable("E"), variable("EC"), variable("U")
    cells = [[output.index_of(cell) for cell in data["rules"][row]] for row in data["E"]["terms"]]
    return fuzzy.Controller(
        error=error, error_change=error_change, output=output, rules=fuzzy.RuleBase(cells), name=data["name"]
    )
