//! The files that a job reads and leaves.

use super::Job;
use crate::pipeline::Pipeline;
use crate::pipeline::films::FACTS;
use crate::pipeline::meshes::purpose_name;
use crate::pipeline::stimuli::MadeWith;
use crate::{fields, recipe};
use anyhow::Result;
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, Study};

impl Pipeline<'_> {
    /// The folder's files that a job leaves.
    pub(super) fn outputs(&self, job: &Job<'_>) -> Vec<String> {
        let (codes, _) = self.study.code_names();
        match job {
            Job::Budget(purpose, of) => vec![format!("budgets/{}/{}.json", purpose_name(*purpose), of.id)],
            Job::Mesh(purpose, of) => {
                let path = format!("meshes/{}/{}", purpose_name(*purpose), of.id);
                let endings: &[&str] = match purpose {
                    Purpose::Indexed => &["json"],
                    _ if self.study.shown_files().is_some() => &["ply"],
                    _ => &["ply", "json"],
                };
                endings.iter().map(|ending| format!("{path}.{ending}")).collect()
            }
            Job::Turntable(of) => {
                let place = self.study.configurations.iter().position(|other| other == *of);
                let code = place.map_or("", |place| &codes[place]);
                vec![format!("stimuli/turntables/{code}.gif"), MadeWith::file(&of.id)]
            }
            Job::Films => vec![FACTS.into()],
            Job::Pair(of) => vec![format!("stimuli/pairs/{}.{}", of.code, self.pair_ending())],
            Job::Still(of) => ["png", "svg"].map(|ending| format!("figures/{}.{ending}", of.id)).to_vec(),
            Job::ViewerMesh(of, factor) => vec![format!("viewer/{}_{factor}.json", of.id)],
            Job::Timings | Job::OnMachine(_) => {
                ["run.json", "samples.csv"].map(|name| format!("{}/{name}", job.id(self.study))).to_vec()
            }
            Job::Cases(of, block) => vec![block.file(*of)],
            Job::Chunks(_) | Job::Stored(_) | Job::Report => Vec::new(),
        }
    }
}

/// The files that a study names, each read once.
pub(super) struct NamedFiles {
    /// By the object's place.
    of_objects: Vec<Vec<String>>,
    /// By the method's place.
    of_methods: Vec<Vec<String>>,
}

impl NamedFiles {
    pub(super) fn of(study: &Study) -> Result<Self> {
        let resolved = |files: Vec<(String, String)>| -> Vec<String> {
            // What a header names is listed with it.
            let named = files.into_iter().filter(|(name, _)| !name.starts_with("samples of "));
            named.map(|(name, _)| study.resolve(&name).display().to_string()).collect()
        };
        let objects = 0..study.file.objects.len();
        Ok(Self {
            of_objects: objects
                .map(|object| Ok(resolved(fields::files(study, object)?)))
                .collect::<Result<_>>()?,
            of_methods: study
                .methods
                .iter()
                .map(|method| Ok(resolved(recipe::files(study, method.id)?)))
                .collect::<Result<_>>()?,
        })
    }

    pub(super) fn of_job(&self, study: &Study, job: &Job<'_>) -> Vec<String> {
        let reads = |of: &Configuration| match job {
            Job::Budget(_, own) | Job::Mesh(_, own) | Job::Turntable(own) | Job::ViewerMesh(own, _) => {
                of == *own
            }
            Job::Cases(_, block) => of == block.configuration,
            Job::Still(still) => of.id == still.configuration,
            Job::Pair(_) | Job::Films => false,
            Job::Chunks(object) | Job::Stored(object) => of.object == *object,
            Job::Timings | Job::OnMachine(_) | Job::Report => true,
        };
        let mut files = vec![study.path.display().to_string()];
        let shows = |of: &Configuration| match job {
            // All of an object are placed as one.
            Job::Mesh(_, own) => of.object == own.object,
            Job::Films | Job::Report => true,
            Job::Pair(pair) => study.shows_films() && pair.shown.contains(&of.id),
            _ => false,
        };
        for of in study.configurations.iter().filter(|of| shows(of)) {
            files.extend(
                study
                    .file
                    .stimuli
                    .file_of(&of.id)
                    .map(|file| study.resolve(&file.file).display().to_string()),
            );
        }
        if let (Job::Report, Some(responses)) = (job, &study.responses) {
            files.push(responses.display().to_string());
        }
        for of in study.configurations.iter().filter(|of| reads(of)) {
            let method = study.methods.iter().position(|method| method.id == of.id.method);
            let of_method = method.map_or(&[][..], |place| &self.of_methods[place]);
            for file in self.of_objects[of.object].iter().chain(of_method) {
                if !files.contains(file) {
                    files.push(file.clone());
                }
            }
        }
        files
    }
}
