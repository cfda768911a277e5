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

  function bars(counts) {
    const most = Math.max(1, ...counts);
    $('minutes').replaceChildren(...counts.map((count, i) => {
      const bar = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
      const height = (78 * count) / most;
      for (const [name, value] of Object.entries({ x: i * 10 + 1, y: 80 - height, width: 8, height, fill: 'currentColor' })) {
        bar.setAttribute(name, value);
      }
      return bar;
    }));
  }

  async function show() {
    clearTimeout(timer);
    try {
      const stand = await (await ask('summary')).json();
      sessionStorage.setItem('isostudy:token', token);
      $('door').hidden = true;
      $('stand').hidden = false;
      const live = stand.forms.map(([, started]) => started);
      const numbers = [
        ['Participants who began', stand.started], ['who finished', stand.finished], ['answering now', stand.answering],
        ['Answers', stand.answers], ['in the last minute', stand.per_minute[59]],
        ['Participants a form', `${Math.min(...live)} to ${Math.max(...live)}`],
      ];
      $('numbers').replaceChildren(...numbers.flatMap(([name, value]) => {
        const [term, text] = [document.createElement('dt'), document.createElement('dd')];
        term.textContent = name;
        text.textContent = value;
        return [term, text];
      }));
      bars(stand.per_minute);
      table('forms', ['Form', 'Participants', 'Finished'], stand.forms);
      table('places', ['Place', 'Answers', 'Median, s'], stand.places.map(([place, answers, median]) => [place, answers, (median / 1000).toFixed(1)]));
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
