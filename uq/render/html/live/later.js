// Do long work once nothing else has been asked for some time, in pieces between which the page answers.

const PAUSE = 150, PIECE = 30; // ms

function laterOf() {
  let waiting;
  return work => {
    clearTimeout(waiting);
    const go = () => {
      for (const until = performance.now() + PIECE; performance.now() < until;) if (work.next().done) return;
      waiting = setTimeout(go);
    };
    waiting = setTimeout(go, PAUSE);
  };
}
