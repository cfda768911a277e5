//! Simulations of the server: clients, a network that loses, repeats and reorders, a clock, kills, power cuts, and a disk that
//! fails at any operation, all from one seed. What answers is the real router, its handlers and the real journal over SQLite.
//!
//! The oracle ([`people`]): each answer that was acknowledged is in every export once, as it was sent, and nothing is there that
//! nobody sent. The server starts again after every crash, and everybody can go on to the end.

mod chance;
mod clients;
mod disk;
mod machine;
mod people;
mod running;
mod tests;

use super::Settings;
use crate::deidentify::deidentified;
use crate::export::Given;
use crate::journal::kept_on;
use chance::Chance;
use clients::{Client, body, path};
use disk::{End, Fault};
use machine::Simulated;
use people::{Asked, People, rows, rows_of};
use running::{Reply, Running};

const TOKEN: &str = "a-token-for-simulations";
const FOLDER: &str = "/simulated/answers";
const QUESTIONS: usize = 4;

/// What happens in a simulation.
#[derive(Clone, Copy)]
struct Plan {
    seed: u64,
    /// A fault that many operations after the beginning, in an otherwise quiet world.
    fault: Option<(u64, Fault)>,
    /// Whether chance does all that it can.
    wild: bool,
    /// Whether everything is printed.
    told: bool,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Outcome {
    /// Sessions of which an answer was acknowledged.
    sessions: usize,
    answers: usize,
    operations: u64,
    failed: u64,
    ends: u64,
    /// The last export.
    export: String,
}

struct Simulation<'a> {
    machine: &'a Simulated,
    settings: &'a Settings,
    plan: Plan,
    chance: Chance,
    people: People,
    clients: Vec<Client>,
    /// Whose request, and what.
    network: Vec<(usize, Asked)>,
    server: Option<Running>,
    ends: u64,
    export: String,
}

/// What was promised and is not so.
type Checked<T = ()> = Result<T, String>;

fn simulate(machine: &Simulated, settings: &Settings, plan: Plan) -> Checked<Outcome> {
    let mut simulation = Simulation::new(machine, settings, plan);
    if let Some((at, fault)) = plan.fault {
        machine.state().disk.arm(at, fault);
    }
    simulation.run()?;
    let Simulation { people, ends, export, .. } = simulation;
    let disk = &machine.state().disk;
    let (operations, failed) = (disk.operations(), disk.failed());
    let answers = people.sessions.values().map(people::Session::acknowledged).sum();
    Ok(Outcome { sessions: people.answered(), answers, operations, failed, ends, export })
}

impl<'a> Simulation<'a> {
    fn new(machine: &'a Simulated, settings: &'a Settings, plan: Plan) -> Self {
        machine.reset(plan.seed);
        let mut chance = Chance::new(plan.seed ^ 0x5eed);
        let panels = [None, Some(0), Some(1), Some(1)];
        let count = if plan.wild { 2 + chance.below(5) } else { 2 };
        let clients = (0..count).map(|number| Client::of(panels[number % panels.len()])).collect();
        Self {
            machine,
            settings,
            plan,
            chance,
            people: People::default(),
            clients,
            network: Vec::new(),
            server: None,
            ends: 0,
            export: String::new(),
        }
    }

    fn tell(&self, line: impl FnOnce() -> String) {
        if self.plan.told {
            println!("{:>6} {}", self.machine.state().disk.operations(), line());
            self.machine.notes().iter().for_each(|note| println!("       log: {note}"));
        }
    }

    fn run(&mut self) -> Checked {
        self.start()?;
        if self.plan.wild {
            for _ in 0..20 + self.chance.below(40) {
                self.step()?;
            }
            self.machine.state().disk.heal();
        } else {
            self.finish_all()?;
            self.restart()?;
            // What comes late, and after a stop.
            self.clients.push(Client::of(Some(7)));
        }
        self.finish_all()?;
        self.machine.state().disk.heal();
        self.check()?;
        match self.chance.below(3) {
            0 => self.restart()?,
            1 => self.crash(End::Killed)?,
            _ => self.crash(End::PowerGone)?,
        }
        self.check()?;
        self.stop()?;
        self.read_folder(false)
    }

    /// Everybody goes on until they have answered all, which has to come.
    fn finish_all(&mut self) -> Checked {
        for _ in 0..400 {
            if self.clients.iter().all(|client| client.done) {
                return Ok(());
            }
            for number in 0..self.clients.len() {
                self.act(number, false);
                self.deliver(false)?;
            }
        }
        Err("not everybody could finish".into())
    }

    fn step(&mut self) -> Checked {
        let later = match self.chance.below(100) {
            0..3 => 3 * 3_600_000,
            3..5 => -3_600_000,
            _ => self.chance.below(5000) as i64,
        };
        self.machine.state().now_ms += later;
        for _ in 0..1 + self.chance.below(3) {
            let number = self.chance.below(self.clients.len());
            self.act(number, true);
        }
        match self.chance.below(100) {
            0..4 => self.restart()?,
            4..8 => self.crash(End::Killed)?,
            8..11 => self.crash(End::PowerGone)?,
            11..25 => {
                let fault = match self.chance.below(9) {
                    0 | 1 => Fault::Error,
                    2 => Fault::Short,
                    3 => Fault::Full(1 + self.chance.below(40) as u64),
                    4 | 5 => Fault::End(End::Killed),
                    _ => Fault::End(End::PowerGone),
                };
                let ahead = 1 + self.chance.below(80) as u64;
                self.tell(|| format!("{fault:?} in {ahead}"));
                self.machine.state().disk.arm(ahead, fault);
            }
            25..30 => self.check()?,
            _ => {}
        }
        self.deliver(true)
    }

    fn start(&mut self) -> Checked {
        for _ in 0..100 {
            let failed = self.machine.state().disk.failed();
            let pages = [1, 4, 20, 1000][self.chance.below(4)];
            let started = Running::start(self.machine, self.settings, pages);
            let (ended, untroubled) = {
                let disk = &self.machine.state().disk;
                (disk.end().is_some(), disk.failed() == failed)
            };
            match started {
                Ok(server) if !ended => {
                    self.tell(|| "started".into());
                    self.server = Some(server);
                    self.people.life += 1;
                    return if untroubled { self.check_exactly() } else { Ok(()) };
                }
                Err(error) if !ended && untroubled => return Err(format!("it does not start: {error}")),
                started => {
                    self.tell(|| format!("not started: {:?}", started.as_ref().err()));
                    drop(started);
                }
            }
            if ended {
                self.restart_machine()?;
            }
        }
        Err("it does not start".into())
    }

    fn stop(&mut self) -> Checked {
        let Some(server) = self.server.take() else { return Ok(()) };
        let stopped = server.stop();
        self.tell(|| format!("stopped: {stopped:?}"));
        if self.machine.state().disk.end().is_some() {
            return self.restart_machine();
        }
        stopped.map_err(|error| format!("it does not stop: {error}"))
    }

    fn restart(&mut self) -> Checked {
        self.stop()?;
        self.start()
    }

    /// Ends the server where it is, and starts it again.
    fn crash(&mut self, end: End) -> Checked {
        self.machine.state().disk.stop(end);
        self.again()
    }

    /// The server has ended, and is started.
    fn again(&mut self) -> Checked {
        self.server = None;
        if self.machine.state().disk.end().is_some() {
            self.restart_machine()?;
        }
        self.start()
    }

    fn restart_machine(&mut self) -> Checked {
        let end = self.machine.state().disk.end();
        self.tell(|| format!("{end:?}"));
        self.ends += 1;
        self.machine.state().disk.restart();
        if self.plan.wild && self.chance.percent(20) { self.read_folder(false) } else { Ok(()) }
    }

    /// Hands some requests to the server at once, and what it says to whoever asked.
    fn deliver(&mut self, wild: bool) -> Checked {
        let Some(server) = &mut self.server else { return Err("no server".into()) };
        let mut sent = Vec::new();
        for _ in 0..1 + self.chance.below(4) {
            if self.network.is_empty() {
                break;
            }
            let (number, asked) = self.network.swap_remove(self.chance.below(self.network.len()));
            if wild && self.chance.percent(8) {
                self.network.push((number, asked.clone()));
            }
            let before = self.people.acknowledged(&asked);
            let pending = server.send(path(&asked), Some(body(&self.people, &asked)));
            sent.push((number, asked, before, pending));
        }
        if wild && self.chance.percent(5) {
            // Somebody closes the page.
            sent.pop();
        }
        let worked = server.work();
        let ended = self.machine.state().disk.end().is_some();
        for (number, asked, before, pending) in sent {
            let reply = pending.reply();
            self.tell(|| format!("{number}: {asked:?}: {reply:?}"));
            match reply {
                Some(reply) => {
                    self.people.learn(&asked, before, &reply)?;
                    if !(wild && self.chance.percent(10)) {
                        self.hear(number, &asked, &reply);
                    }
                }
                None if ended || worked.is_err() => {}
                None => return Err(format!("nobody answered {asked:?}")),
            }
        }
        if let Err(error) = &worked {
            self.tell(|| format!("ended by itself: {error}"));
        }
        if ended || worked.is_err() { self.again() } else { Ok(()) }
    }

    /// Reads every export, and holds it against what was told.
    fn check(&mut self) -> Checked {
        self.compare(false)
    }

    /// The same where nothing may be there but what belongs to an answer.
    fn check_exactly(&mut self) -> Checked {
        self.compare(true)
    }

    fn compare(&mut self, exact: bool) -> Checked {
        let failed = self.machine.state().disk.failed();
        let paths = ["/api/admin/answers.csv", "/api/admin/identities.csv", "/api/admin/summary"];
        let Some(server) = &mut self.server else { return Err("no server".into()) };
        let replies = paths.map(|path| server.ask(path));
        let troubled = self.machine.state().disk.failed() != failed;
        let mut texts = Vec::new();
        for (reply, path) in replies.into_iter().zip(paths) {
            match reply {
                Some(Reply { status: 200, text }) => texts.push(text),
                _ if troubled => {}
                other => return Err(format!("{path}: {other:?}")),
            }
        }
        if let [answers, identities, summary] = &texts[..] {
            let rows = rows(answers)?;
            self.people.check_rows("answers.csv", &rows, true)?;
            self.people.check_identities(identities, &rows, exact)?;
            self.people.check_summary(summary, &rows)?;
            self.export.clone_from(answers);
        }
        if self.machine.state().disk.end().is_some() {
            return self.again();
        }
        self.read_folder(true)?;
        if self.machine.state().disk.end().is_some() { self.again() } else { Ok(()) }
    }

    /// What `analyse` and `deidentify` read, beside a server or without one.
    fn read_folder(&mut self, served: bool) -> Checked {
        let failed = self.machine.state().disk.failed();
        let kept = kept_on(self.machine, FOLDER.as_ref(), "trial");
        let troubled = self.machine.state().disk.failed() != failed;
        let (given, cameras) = match kept {
            Ok(kept) => (kept.given, kept.cameras),
            // Nothing was made yet.
            Err(_) if troubled || self.people.sessions.is_empty() => return Ok(()),
            Err(error) => return Err(format!("the folder cannot be read: {error}")),
        };
        self.people.check_rows("the folder", &rows_of(&given)?, served)?;
        self.people.check_cameras("the folder", &cameras)?;
        let shared = deidentified(&given);
        let without = |given: &[Given]| {
            let mut answers: Vec<_> = given
                .iter()
                .map(|one| {
                    format!("{} {:?}", one.form, (one.answer.order, one.answer.choice, one.answer.rt_ms))
                })
                .collect();
            answers.sort();
            answers
        };
        if without(&shared) != without(&given) || rows_of(&shared)?.len() != given.len() {
            return Err("what is shared are other answers".into());
        }
        Ok(())
    }
}
