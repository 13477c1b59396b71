// How the site's search sorts: guides before the names of the Python reference in which a word merely occurs.
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 2,
  objPrio: {0: 15, 1: 0, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
