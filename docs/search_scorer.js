// The order of what a search finds: the guide first, then machines and statistics, then the reference.
const PLACES = [
  [/^(index|guide\/)/, 40],
  [/^(machines\/|statistics|nomenclature|clusters|scaling|gallery)/, 15],
  [/^(coverage|changelog|contributing|architecture|faults|papers)/, -40],
];
var Scorer = {
  score: ([page, title, anchor, description, score]) =>
    score + (PLACES.find(([names]) => names.test(page)) ?? [null, 0])[1],
  objNameMatch: 11, objPartialMatch: 6, objPrio: { 0: 5, 1: 0, 2: -5 }, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
