/** Texts with the row that each stands in: the uppermost in which it overlaps none that begins before it. */
export function in_rows<T extends { left: number; width: number }>(texts: T[]): (T & { row: number })[] {
  const ends: number[] = [];
  return [...texts]
    .sort((a, b) => a.left - b.left)
    .map((text) => {
      const free = ends.findIndex((end) => end <= text.left);
      const row = free < 0 ? ends.length : free;
      ends[row] = text.left + text.width;
      return { ...text, row };
    });
}
