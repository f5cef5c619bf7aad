// Names in unnamed namespaces differ within a folder, since its sources are compiled together (veridyn_compile_together in
// cmake/VeridynBuild.cmake), those of a folder with fewer than three as part of the folder above. Prints each name that two
// sources of such a unit have, with both places; exit code 1 where there is one. Overloads may have one name.
//   node tools/unnamed_names.mjs [FOLDER...]   (default: every module, the reproductions, the program, and their tests)
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

const kSmallestUnit = 3;

/// The sources of a folder, deep.
function sources(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return sources(path);
    return entry.name.endsWith('.cpp') ? [path] : [];
  });
}

/// Folders of `folder`.
const folders = (folder) => readdirSync(folder, { withFileTypes: true }).filter((entry) => entry.isDirectory()).map((entry) => join(folder, entry.name));

/// Text without comments and the contents of literals; as many lines as before.
function code(text) {
  return text.replace(/R"(\w*)\([\s\S]*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\/\/[^\n]*|\/\*[\s\S]*?\*\//g, (piece) => {
    const quote = piece.startsWith('/') ? '' : '""';
    return quote + '\n'.repeat(piece.split('\n').length - 1);
  });
}

/// The types of a parameter list at the beginning of `text`: functions of one name that differ in them are overloads.
function parameters(text) {
  let depth = 0;
  let end = 0;
  do {
    depth += text[end] === '(' ? 1 : text[end] === ')' ? -1 : 0;
  } while (depth > 0 && ++end < text.length);
  return text.slice(0, end + 1).replace(/ = [^,()]*(\([^()]*\))?/g, '').replace(/([\w>&*\]]) \w+(?=[,)])/g, '$1');
}

/// The names that one statement at the level of a namespace declares: what stands before its body or its end.
function declared(statement) {
  let text = statement.replace(/\[\[[^\]]*\]\]/g, ' ').replace(/\s+/g, ' ').trim();
  text = text.replace(/^template <.*?> ?(?=(?:struct|class|using|inline|constexpr|const|static|auto|bool|int|void|double|[A-Z])\b)/, '');
  let found = text.match(/^(?:struct|class|enum class|enum|union) (\w+)(?: final)? ?(?:[:{;]|$)/);
  if (found) return [found[1]];
  found = text.match(/^using (\w+) ?= ?(.*);$/);
  if (found) return [`${found[1]} = ${found[2]}`];
  if (/^(using|static_assert|namespace|extern|friend|#|TEST|TYPED_TEST|INSTANTIATE|REGISTER|BENCHMARK)/.test(text)) return [];
  // A function: the name before the first parenthesis outside of <...>. A variable: the last name before = { [ or the end.
  let depth = 0;
  for (let i = 0; i < text.length; ++i) {
    if (text[i] === '<') ++depth;
    if (text[i] === '>' && text[i - 1] !== '-') --depth;
    if (depth > 0 || !'(={[;'.includes(text[i])) continue;
    const name = text.slice(0, i).match(/([\w:~]+|operator ?\S+) ?$/);
    if (!name || name[1].includes('::') || name[1].startsWith('operator')) return [];
    if (!/\s/.test(text.slice(0, i).trim())) return [];
    return [text[i] === '(' ? name[1] + parameters(text.slice(i)) : name[1]];
  }
  return [];
}

/// Names at the level of the unnamed namespaces of a source, with their lines.
function unnamed(path) {
  const names = new Map();
  const text = code(readFileSync(path, 'utf8'));
  const opening = /^namespace \{/gm;
  for (let open = opening.exec(text); open; open = opening.exec(text)) {
    let begin = opening.lastIndex;
    let [braces, parentheses] = [0, 0];
    let i = begin;
    for (; i < text.length; ++i) {
      const c = text[i];
      if (c === '\n' && text[i + 1] === '#') {
        i = text.indexOf('\n', i + 1) - 1;
        begin = i + 1;
        continue;
      }
      if (c === '(') ++parentheses;
      if (c === ')') --parentheses;
      if (c === '{' && parentheses === 0 && braces++ === 0) {
        const line = text.slice(0, begin + text.slice(begin).search(/\S/)).split('\n').length;
        for (const name of declared(text.slice(begin, i + 1))) if (!names.has(name)) names.set(name, line);
      }
      if (c === '}' && parentheses === 0) {
        if (braces === 0) break;
        if (--braces === 0) begin = i + 1;
      }
      if (c === ';' && braces === 0 && parentheses === 0) {
        const statement = text.slice(begin, i + 1);
        if (statement.trim() !== ';' ) {
          const line = text.slice(0, begin + statement.search(/\S/)).split('\n').length;
          for (const name of declared(statement)) if (!names.has(name)) names.set(name, line);
        }
        begin = i + 1;
      }
    }
    opening.lastIndex = i;
  }
  return names;
}

const given = process.argv.slice(2);
const modules = given.length > 0 ? given : [...folders('veridyn'), 'bench/reproduction', ...folders('apps'), ...folders('tests')];
let faults = 0;
for (const module of modules) {
  const paths = sources(module).sort();
  const inFolder = new Map();
  for (const path of paths) inFolder.set(dirname(path), (inFolder.get(dirname(path)) ?? 0) + 1);
  const first = new Map();
  for (const path of paths) {
    const folder = dirname(path);
    const unit = folder !== module && inFolder.get(folder) < kSmallestUnit ? dirname(folder) : folder;
    for (const [name, line] of unnamed(path)) {
      // The same alias may stand twice; another of its name, or anything else, may not.
      const key = `${unit} ${name.split(' = ')[0]}`;
      if (first.get(key)?.name === name && name.includes(' = ')) continue;
      if (first.has(key)) {
        console.error(`${path}:${line}: '${name}' is also in the unnamed namespace of ${first.get(key).place}`);
        ++faults;
      } else {
        first.set(key, { name, place: `${path}:${line}` });
      }
    }
  }
}
if (faults > 0) console.error(`unnamed_names: ${faults} names stand twice in the unnamed namespaces of a folder`);
process.exit(faults > 0 ? 1 : 0);
