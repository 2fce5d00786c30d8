"""Numbers, directions and choices at random: what scenes are made of."""


def between(r, low, high):
    """As likely between 1 and 10 as between 10 and 100."""
    return low * (high / low) ** r.random()


def some(r, share, **fields):
    """Each of the fields with this chance."""
    return {name: value for name, value in fields.items() if r.random() < share}


def vector(r, reach):
    return [r.uniform(-reach, reach) for _ in range(3)]


def direction(r, length=1):
    """A direction, or an orientation of a length of its own."""
    return [length * r.gauss(0, 1) for _ in range(3)]


def orientation(r):
    """A quaternion of any length but zero, and now and then one that needs no rounding."""
    return r.choice([[r.gauss(0, 1) for _ in range(4)] for _ in range(4)] + [[1, 1, 0, 0], [0, 0, 0, 2]])


def plus(a, b):
    return [x + y for x, y in zip(a, b)]
