// SPDX-License-Identifier: Apache-2.0
// The syntax of the search fields: every word must match; a word with an asterisk is a pattern for the whole name.

function test_of(word: string): (text: string) => boolean {
  if (!word.includes('*')) return (text) => text.includes(word);
  const pattern = word
    .split('*')
    .map((part) => part.replace(/[.?+^${}()|[\]\\]/g, '\\$&'))
    .join('.*');
  const whole = new RegExp(`^${pattern}$`);
  return (text) => whole.test(text);
}

// Whether each word of the query matches one of the names.
export function matcher(query: string): (names: string[]) => boolean {
  const tests = query.toLowerCase().split(/\s+/).filter(Boolean).map(test_of);
  return (names) => {
    const lower = names.map((name) => name.toLowerCase());
    return tests.every((test) => lower.some(test));
  };
}
