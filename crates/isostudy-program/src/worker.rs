//! A running program: started, asked, ended.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use isostudy_foreign::{Child, End, Folder, Heard, Limits, Memory, Stopped};

use crate::answer::{self, Answer, Done, Ready};
use crate::error::{Phase, Problem, ProgramError, shortened};
use crate::mesh_file;
use crate::program::Program;
use crate::request::{Line, Request, Samples, write_samples};
use crate::sandbox;

/// The longest line that a program may say, without its end.
pub const LINE_LIMIT_BYTES: usize = 65_536;

/// How long a program that closed its output may take to end.
const PARTING: Duration = Duration::from_secs(1);

/// A running program. Dropped, its process group is killed and its folder removed.
#[derive(Debug)]
pub struct Worker {
    // Dropped in this order: nothing of the child may live when the folder goes.
    child: Child,
    program: Program,
    ready: Ready,
    last_id: u64,
    running: bool,
    folder: Folder,
}

impl Worker {
    /// Starts the program in an empty folder of its own, which is also its `TMPDIR`, and waits until it is ready. It inherits
    /// the environment and the CPUs that the calling thread is pinned to.
    ///
    /// # Errors
    /// Those of [`Program::check`], and whatever keeps the program from being ready in time; it is gone then.
    pub fn start(program: &Program) -> Result<Self, ProgramError> {
        let mut worker = Self::spawn(program).map_err(|problem| program.error(problem))?;
        match worker.hear_ready() {
            Ok(ready) => worker.ready = ready,
            Err(problem) => return Err(worker.stop(problem)),
        }
        Ok(worker)
    }

    /// What the program said of itself.
    pub fn ready(&self) -> &Ready {
        &self.ready
    }

    /// The program's own folder. Meshes and samples may be put here; it goes with the worker.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The number of its first process, for those who account for CPU time.
    pub fn process(&self) -> u32 {
        self.child.id()
    }

    /// Whether it may be asked. After an error that leaves both sides in step (`failed`, a broken mesh, a request that cannot
    /// be made) it may; after any other it was killed, and another has to be started.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// The memory of the program and all that it started; `None` where it cannot be seen.
    pub fn memory(&mut self) -> Option<Memory> {
        self.child.memory(true)
    }

    /// Asks for one isosurface and waits for it, with the mesh if there is to be one.
    ///
    /// # Errors
    /// [`ProgramError`]. See [`Worker::is_running`] for what comes after it.
    pub fn extract(&mut self, request: &Request<'_>) -> Result<Answer, ProgramError> {
        if !self.running {
            return Err(self.program.error(Problem::Stopped));
        }
        match self.ask(request) {
            Ok(answer) => Ok(answer),
            Err(problem) if problem.is_in_step() => {
                let stderr = self.child.words();
                Err(ProgramError { stderr, ..self.program.error(problem) })
            }
            Err(problem) => Err(self.stop(problem)),
        }
    }

    /// Closes the program's input and waits until it has ended, at most for the time limit. Without this call it is killed, and
    /// a second answer to the last request is not seen.
    ///
    /// # Errors
    /// If it says something more, does not end, or ends with a code other than 0.
    pub fn finish(mut self) -> Result<(), ProgramError> {
        if !self.running {
            return Err(self.program.error(Problem::Stopped));
        }
        self.child.close_input();
        let limit = self.program.time_limit;
        match self.listen(Phase::Finish) {
            Ok((line, _)) => Err(self.stop(Problem::Unasked { line: shortened(&line) })),
            Err(Problem::Ended { end: End::Code(0), rest, .. }) if rest.is_empty() => {
                self.running = false;
                Ok(())
            }
            Err(Problem::TimeLimit { .. }) => Err(self.stop(Problem::NotEnded { limit })),
            Err(Problem::Ended { end: End::NotYet, .. }) => {
                Err(self.stop(Problem::NotEnded { limit: PARTING }))
            }
            Err(problem) => Err(self.stop(problem)),
        }
    }

    fn spawn(program: &Program) -> Result<Self, Problem> {
        let mut words = program.resolved()?;
        let folder = Folder::new().map_err(Problem::io(&std::env::temp_dir()))?;
        if program.sandbox {
            sandbox::check()?;
            words = sandbox::confined(words, folder.path());
        }
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).current_dir(folder.path()).env("TMPDIR", folder.path());
        let limits = Limits { line_bytes: LINE_LIMIT_BYTES, memory_bytes: program.memory_limit_bytes };
        let child = Child::start(&mut command, limits, None).map_err(Problem::Start)?;
        Ok(Self {
            child,
            program: program.clone(),
            ready: Ready { name: String::new(), version: String::new(), note: None },
            last_id: 0,
            running: true,
            folder,
        })
    }

    fn hear_ready(&mut self) -> Result<Ready, Problem> {
        let (line, _) = self.listen(Phase::Start)?;
        answer::ready(&line)
    }

    fn ask(&mut self, request: &Request<'_>) -> Result<Answer, Problem> {
        request.check()?;
        let own_samples = self.folder.path().join("samples.f32");
        let samples = match request.samples {
            Samples::Values(values) => {
                write_samples(&own_samples, values).map_err(Problem::io(&own_samples))?;
                own_samples
            }
            Samples::File(path) => std::path::absolute(path).map_err(Problem::io(path))?,
        };
        let mesh = request.mesh.map(|path| self.folder.path().join(path));
        if let Some(path) = &mesh {
            mesh_file::clear(path)?;
        }
        if let Some(heard) = self.child.unasked() {
            return Err(self.unasked(heard));
        }
        self.last_id += 1;
        let id = self.last_id;
        let Request { size, origin, spacing, isovalue, .. } = *request;
        let line = Line { id, samples: &samples, size, origin, spacing, isovalue, mesh: mesh.as_deref() };
        let mut line = serde_json::to_vec(&line)
            .map_err(|error| Problem::Request { key: "samples, mesh", reason: error.to_string() })?;
        line.push(b'\n');
        let before = self.child.cpu();
        let (done, wall) = self.answered(line, id)?;
        // A process that ended in between takes its time along, unless it was waited for.
        let cpu = before.zip(self.child.cpu()).and_then(|(before, after)| after.checked_sub(before));
        let memory = self.child.memory(true);
        self.child.check_memory(memory).map_err(|stopped| self.stopped(stopped, Phase::Request(id)))?;
        if done.triangles == 0 && !request.may_be_empty {
            return Err(Problem::Empty { id });
        }
        let limit = self.program.memory_limit_bytes;
        let mesh = mesh.map(|path| mesh_file::read(&path, request, &done, limit)).transpose()?;
        let Done { extraction_s, callback_s, peak_bytes, vertices, triangles, .. } = done;
        Ok(Answer { extraction_s, callback_s, peak_bytes, wall, cpu, vertices, triangles, mesh, memory })
    }

    fn answered(&mut self, line: Vec<u8>, id: u64) -> Result<(Done, Duration), Problem> {
        let asked = Instant::now();
        self.child.send(line);
        let (line, at) = self.listen(Phase::Request(id))?;
        let Some(wall) = at.checked_duration_since(asked) else {
            return Err(Problem::Unasked { line: shortened(&line) });
        };
        Ok((answer::done(&line, id, wall)?, wall))
    }

    /// The next line, and when it came.
    fn listen(&mut self, phase: Phase) -> Result<(Vec<u8>, Instant), Problem> {
        let heard = self.child.listen(self.program.time_limit);
        heard.map_err(|stopped| self.stopped(stopped, phase))
    }

    fn stopped(&self, stopped: Stopped, phase: Phase) -> Problem {
        match stopped {
            Stopped::TimeLimit => Problem::TimeLimit { phase, limit: self.program.time_limit },
            Stopped::MemoryLimit { bytes, limit } => Problem::MemoryLimit { phase, bytes, limit },
            Stopped::TooLong(start) => {
                let start = shortened(&start[..start.len().min(100)]);
                Problem::LineTooLong { phase, limit: LINE_LIMIT_BYTES, start }
            }
            Stopped::Ended(end, rest) => Problem::Ended { phase, end, rest: shortened(&rest) },
        }
    }

    fn unasked(&mut self, heard: Heard) -> Problem {
        match heard {
            Heard::Line(line, _) | Heard::TooLong(line) => Problem::Unasked { line: shortened(&line) },
            Heard::End(rest) => {
                let phase = Phase::Request(self.last_id + 1);
                match self.child.listen(PARTING) {
                    Err(Stopped::Ended(end, _)) => Problem::Ended { phase, end, rest: shortened(&rest) },
                    Err(stopped) => self.stopped(stopped, phase),
                    Ok((line, _)) => Problem::Unasked { line: shortened(&line) },
                }
            }
        }
    }

    fn stop(&mut self, problem: Problem) -> ProgramError {
        self.running = false;
        self.child.kill();
        ProgramError { stderr: self.child.last_words(), ..self.program.error(problem) }
    }
}
