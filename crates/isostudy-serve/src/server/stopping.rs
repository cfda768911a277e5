//! A stopping rule that the study declared: at each planned look the tests say whether anybody more is asked.
//!
//! A look takes the people who finished first, exactly as many as were planned for it. So nobody looks between the looks, and what one
//! says does not depend on when the page is opened.

use super::{Shared, Site};
use crate::export::Given;
use crate::journal::Journal;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Whether the answers given so far stop the study; an error is said to the researcher.
pub type Judge = dyn Fn(&[Given]) -> Result<bool, String> + Send + Sync;

/// A rule.
#[derive(Clone)]
pub struct Rule {
    /// Numbers of people who have finished, ascending.
    pub looks: Vec<u32>,
    /// What the tests say at a look.
    pub judge: Arc<Judge>,
}

impl fmt::Debug for Rule {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("Rule").field("looks", &self.looks).finish_non_exhaustive()
    }
}

/// What the looks said so far, by their places.
pub(super) type Looked = Mutex<BTreeMap<usize, Result<bool, String>>>;

/// What a rule says now.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Says {
    /// No look has been reached.
    Wait,
    /// Ask more people.
    GoOn,
    /// Ask nobody more: the contrasts that decide differ.
    Stop,
    /// Ask nobody more: the last look has been reached.
    End,
    /// The tests could not be made.
    Failed(String),
}

/// Where the looks stand.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Standing {
    /// The planned looks.
    looks: Vec<u32>,
    /// The look that speaks, from 1; 0 before the first.
    look: usize,
    says: Says,
}

/// What the rule says; each look that has been reached is judged once.
///
/// # Errors
/// If SQLite fails.
pub(super) async fn standing(
    site: &Site,
    rule: &Rule,
    finished: Vec<String>,
) -> Result<Standing, crate::journal::Unsaved> {
    let looks = rule.looks.clone();
    let standing = |look, says| Standing { looks: looks.clone(), look, says };
    let reached = looks.iter().take_while(|&&people| people as usize <= finished.len()).count();
    for look in 0..reached {
        let known = kept(site).get(&look).cloned();
        let verdict = match known {
            Some(known) => known,
            None => {
                let names: BTreeSet<String> = finished[..looks[look] as usize].iter().cloned().collect();
                let mut given = site.journal.read(Journal::given).await?;
                given.retain(|of| names.contains(&of.participant));
                let judge = Arc::clone(&rule.judge);
                let judged = tokio::task::spawn_blocking(move || judge(&given)).await;
                let verdict = judged.unwrap_or_else(|_| Err("the tests of this look failed".into()));
                kept(site).insert(look, verdict.clone());
                verdict
            }
        };
        match verdict {
            Ok(false) => {}
            Ok(true) => return Ok(standing(look + 1, Says::Stop)),
            Err(reason) => return Ok(standing(look + 1, Says::Failed(reason))),
        }
    }
    Ok(standing(
        reached,
        match reached {
            0 => Says::Wait,
            all if all == looks.len() => Says::End,
            _ => Says::GoOn,
        },
    ))
}

fn kept(site: &Shared) -> std::sync::MutexGuard<'_, BTreeMap<usize, Result<bool, String>>> {
    // Nothing that holds it can fail half way.
    site.looked.lock().unwrap_or_else(PoisonError::into_inner)
}
