// The largest of many numbers: of hundreds of thousands, more than a function takes as its arguments.

/** Not below `least`; NaN (not known) is passed over. */
export function largest(values: Iterable<number>, least = 0): number {
  let most = least;
  for (const value of values) if (value > most) most = value;
  return most;
}
