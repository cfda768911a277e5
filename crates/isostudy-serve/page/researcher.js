// The researcher's page. The token stays in this tab.
'use strict';

(() => {
  const $ = (id) => document.getElementById(id);
  let token = sessionStorage.getItem('isostudy:token');
  let timer = 0;

  async function ask(file) {
    const response = await fetch(`api/admin/${file}`, { headers: { authorization: `Bearer ${token}` } });
    if (!response.ok) throw new Error(await response.text());
    return response;
  }

  function table(id, headings, rows) {
    const line = (kind, cells) => {
      const row = document.createElement('tr');
      for (const text of cells) {
        const cell = document.createElement(kind);
        cell.textContent = text;
        if (kind === 'th') cell.scope = 'col';
        row.append(cell);
      }
      return row;
    };
    $(id).replaceChildren(line('th', headings), ...rows.map((cells) => line('td', cells)));
  }

  function drawn(name, attributes, text = '') {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.textContent = text;
    return element;
  }

  /** One bar a minute over a line of time; the scale begins at 0 and ends at the largest count. */
  function bars(counts) {
    const most = Math.max(1, ...counts);
    const [left, top, bottom] = [50, 10, 90];
    const text = (x, y, anchor, words) => drawn('text', { x, y, 'text-anchor': anchor, 'font-size': 13, fill: 'currentColor' }, words);
    const line = (y) => drawn('line', { x1: left, x2: left + 600, y1: y, y2: y, stroke: 'currentColor', 'stroke-width': 0.5 });
    const bar = (count, i) => {
      const height = ((bottom - top) * count) / most;
      return drawn('rect', { x: left + i * 10 + 1, y: bottom - height, width: 8, height, fill: 'currentColor' });
    };
    $('minutes').replaceChildren(
      line(top), line(bottom), text(left - 6, top + 4, 'end', most), text(left - 6, bottom + 4, 'end', 0), ...counts.map(bar),
      text(left, bottom + 18, 'start', '60 minutes ago'), text(left + 300, bottom + 18, 'middle', '30'), text(left + 600, bottom + 18, 'end', 'now'),
    );
    $('minutes').setAttribute('aria-label', `Answers in each of the last 60 minutes: ${most} at most, ${counts.at(-1)} in the last`);
  }

  function expected(stand) {
    if (stand.finished >= stand.planned) return 'all have finished';
    if (stand.expected_end_ms === null) return 'not known yet';
    return new Date(stand.expected_end_ms).toLocaleString();
  }

  /** What the stopping rule says that the study declared. */
  function rule({ looks, look, says }) {
    const all = `The study declared ${looks.length === 1 ? 'a look' : `${looks.length} looks`} at ${looks.join(', ')} participants who finished.`;
    const at = `Look ${look} says:`;
    const words = {
      wait: 'The first look has not been reached.',
      'go-on': `${at} go on. The contrasts that decide do not differ yet at the adjusted level.`,
      stop: `${at} stop. The contrasts that decide differ at the adjusted level.`,
      end: `${at} the study ends here. The contrasts that decide do not differ at the adjusted level.`,
    };
    return `${all} ${words[says] ?? `Look ${look} could not be judged: ${says.failed}`}`;
  }

  async function show() {
    clearTimeout(timer);
    try {
      const stand = await (await ask('summary')).json();
      sessionStorage.setItem('isostudy:token', token);
      $('door').hidden = true;
      $('stand').hidden = false;
      document.title = `${stand.title} \u2013 how the study stands`;
      $('title').textContent = stand.title;
      const live = stand.forms.map(([, started]) => started);
      const numbers = [
        ['Participants who finished', `${stand.finished} of ${stand.planned} planned`], ['who began', stand.started], ['who have begun and not finished', stand.answering],
        ['who answered in the last two minutes', stand.recent],
        ['Answers', stand.answers], ['in the last minute', stand.per_minute[59]],
        ['Participants per form', `${Math.min(...live)} to ${Math.max(...live)}${stand.per_form === null ? '' : `, at most ${stand.per_form}`}`],
        ['Median time from beginning to end', stand.median_ms === null ? 'not known yet' : `${(stand.median_ms / 60000).toFixed(1)} min`],
        ['Expected end, at the pace of the last 24 hours', expected(stand)],
        ['People who withdrew', stand.departures.withdrawn], ['who were screened out', stand.departures.screened_out],
        ['who came when there were enough like them', stand.departures.full],
      ];
      $('numbers').replaceChildren(...numbers.flatMap(([name, value]) => {
        const [term, text] = [document.createElement('dt'), document.createElement('dd')];
        term.textContent = name;
        text.textContent = value;
        return [term, text];
      }));
      bars(stand.per_minute);
      $('stopping').hidden = stand.stopping === null;
      $('stopping').textContent = stand.stopping === null ? '' : rule(stand.stopping);
      table('forms', ['Form', 'Participants', 'Finished'], stand.forms);
      $('quota').hidden = stand.options.length === 0;
      table('options', ['Question', 'Answer', 'People', 'At most'], stand.options.map((option, i) => [...stand.words[i], option.people, option.most]));
      $('leaving').hidden = stand.left.length === 0;
      table('left', ['Answers that they gave', 'People'], stand.left);
      table('questions', ['Question', 'Answers', 'Median, s'], stand.questions.map(([question, answers, median]) => [question, answers, (median / 1000).toFixed(1)]));
      $('status').textContent = `As of ${new Date().toLocaleTimeString()}`;
      timer = setTimeout(show, 5000);
    } catch (error) {
      $('status').textContent = error.message;
      if (!$('stand').hidden) timer = setTimeout(show, 5000);
    }
  }

  $('door').addEventListener('submit', (event) => {
    event.preventDefault();
    token = $('token').value;
    show();
  });
  for (const button of document.querySelectorAll('button[data-file]')) {
    button.addEventListener('click', async () => {
      try {
        const blob = await (await ask(button.dataset.file)).blob();
        const link = document.createElement('a');
        link.href = URL.createObjectURL(blob);
        link.download = button.dataset.file;
        link.click();
      } catch (error) {
        $('status').textContent = error.message;
      }
    });
  }
  if (token) show();
})();
