// Lines of Markdown of at most 120 characters.

export const width = 120;

/// Characters, as an editor counts them.
const length = (text) => [...text].length;

/// Words between which a line may end: not within `code`.
function words(text) {
  const parts = [];
  for (const word of text.split(' ').filter((part) => part !== '')) {
    const open = parts.length > 0 && (parts.at(-1).match(/`/g) ?? []).length % 2 === 1;
    if (open) parts[parts.length - 1] += ` ${word}`;
    else parts.push(word);
  }
  return parts;
}

/// What at the beginning of a line would be read as something else: an item, a heading, a quotation, a table.
const isMarker = (word) => /^([-+*]|#+|>.*|\|.*|\d+[.)]|=+|-+)$/.test(word);

/// Text filled into lines, the first one after `first`, the others after `rest`.
function filled(text, first, rest) {
  const lines = [];
  let line = [];
  const fits = (more) => length((lines.length === 0 ? first : rest) + [...line, more].join(' ')) <= width;
  for (const word of words(text)) {
    if (line.length === 0 || fits(word)) {
      line.push(word);
      continue;
    }
    const moved = [];
    if (isMarker(word) && line.length > 1) moved.push(line.pop());
    lines.push(line.join(' '));
    line = [...moved, word];
  }
  lines.push(line.join(' '));
  return lines.map((content, i) => (i === 0 ? first : rest) + content);
}

/// A document with its long paragraphs and items filled again.
export function wrapped(text) {
  const out = [];
  let block = [];
  let fence = null;
  const flush = () => {
    if (block.some((line) => length(line) > width)) {
      const [, first] = block[0].match(/^(\s*(?:(?:[-+*]|\d+[.)])\s+)?)/);
      const rest = ' '.repeat(first.length);
      out.push(...filled([block[0].slice(first.length), ...block.slice(1).map((line) => line.trim())].join(' '), first, rest));
    } else {
      out.push(...block);
    }
    block = [];
  };
  for (const line of text.split('\n')) {
    const mark = line.match(/^\s*(```+|~~~+)/)?.[1];
    if (fence !== null || mark) {
      flush();
      out.push(line);
      if (fence === null) fence = mark;
      else if (mark?.startsWith(fence)) fence = null;
      continue;
    }
    const alone = /^\s*$|^\s*\||^#|^\s*<|^\s*>|^\s*\[[^\]]+\]:|^\s*(?:-{3,}|={3,})\s*$/.test(line);
    const indented = /^ {4}/.test(line) && block.length === 0;
    if (alone || indented) {
      flush();
      out.push(line);
      continue;
    }
    if (/^\s*(?:[-+*]|\d+[.)])\s/.test(line)) flush();
    block.push(line);
    if (/( {2}|\\)$/.test(line)) flush();
  }
  flush();
  return out.join('\n');
}
