// Lines of Markdown of at most 120 characters. Paragraphs and items of lists with a longer line are filled again; tables,
// headings, code and what cannot be broken stay as they are. Without files: all that git knows or would add.
//   node tools/wrap_markdown.mjs --check|--write [FILE...]
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';

const width = 120;
const [mode, ...named] = process.argv.slice(2);
if (mode !== '--check' && mode !== '--write') {
  console.error('wrap_markdown: node tools/wrap_markdown.mjs --check|--write [FILE...]');
  process.exit(2);
}
const files = named.length > 0 ? named : execFileSync('git', ['ls-files', '-co', '--exclude-standard', '*.md'], { encoding: 'utf8' }).split('\n').filter(Boolean);

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
function wrapped(text) {
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

let wrong = 0;
for (const file of files) {
  const text = readFileSync(file, 'utf8');
  const better = wrapped(text);
  if (better === text) continue;
  if (mode === '--write') {
    writeFileSync(file, better);
    console.log(file);
    continue;
  }
  const line = text.split('\n').findIndex((was, i) => was !== better.split('\n')[i]) + 1;
  console.error(`${file}:${line}: a paragraph has lines of more than ${width} characters (node tools/wrap_markdown.mjs --write)`);
  wrong += 1;
}
process.exit(wrong > 0 ? 1 : 0);
