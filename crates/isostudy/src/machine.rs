//! The machine, and the program that was built from these sources.

use crate::source_digests;
use crate::store::Inputs;
use isostudy_design::machine::Machine;

/// The machine, and the commit and the sources that this program was built from.
pub(crate) fn read() -> Machine {
    let mut machine = isostudy_bench::read_machine();
    let known = |text: &'static str| (!text.is_empty()).then_some(text);
    machine.build.commit = known(env!("ISOSTUDY_COMMIT")).map(Into::into);
    machine.build.dirty = known(env!("ISOSTUDY_DIRTY")).map(|dirty| dirty == "yes");
    machine.build.sources = Some(Inputs::of_sources(source_digests::TIMINGS).finish());
    machine
}
