// SPDX-License-Identifier: Apache-2.0
// What the search fields understand: every word must be found; a word with an asterisk is a pattern of a whole name.

function test_of(word: string): (text: string) => boolean {
  if (!word.includes('*')) return (text) => text.includes(word);
  const pattern = word
    .split('*')
    .map((part) => part.replace(/[.?+^${}()|[\]\\]/g, '\\$&'))
    .join('.*');
  const whole = new RegExp(`^${pattern}$`);
  return (text) => whole.test(text);
}

// Whether each word of the query is found in one of a thing's names.
export function matcher(query: string): (names: string[]) => boolean {
  const tests = query.toLowerCase().split(/\s+/).filter(Boolean).map(test_of);
  return (names) => {
    const lower = names.map((name) => name.toLowerCase());
    return tests.every((test) => lower.some(test));
  };
}
