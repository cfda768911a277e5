//! A run as CSV: every sample, and the machine beside its target.

use crate::profile::compare_profile;
use isostudy_design::record::{BenchRun, BenchSample};
use serde::Serialize;

/// The columns of a sample.
const SAMPLE: [&str; 20] = [
    "id",
    "invocation",
    "iteration",
    "place",
    "allocation_s",
    "sampling_s",
    "vertex_s",
    "geometry_s",
    "clustering_s",
    "normals_s",
    "total_s",
    "reference_s",
    "cpu_s",
    "page_faults",
    "context_switches",
    "instructions",
    "cache_misses",
    "branch_misses",
    "energy_j",
    "outside_s",
];
/// The columns of a property.
const PROPERTY: [&str; 4] = ["property", "target", "machine", "matches"];

/// Every sample in the order measured, a line each, under the column names of
/// [`BenchSample`](isostudy_design::record::BenchSample) and [`Counters`](isostudy_design::record::Counters). Numbers are written so that they read back unchanged.
/// Without samples the names stand alone. Where some method is finished, `finishing_s` is the last column.
pub fn samples_csv(samples: &[BenchSample]) -> String {
    if samples.iter().all(|sample| sample.finishing_s == 0.0) {
        return table(samples, &SAMPLE);
    }
    // A sample writes the column only where it is finished, and not at the end.
    let rows: Vec<(BenchSample, f64)> = samples
        .iter()
        .map(|sample| (BenchSample { finishing_s: 0.0, ..sample.clone() }, sample.finishing_s))
        .collect();
    table(&rows, &[&SAMPLE[..], &["finishing_s"]].concat())
}

/// What is known of the machine, a property a line: `property,target,machine,matches`, the last `true`, `false` or,
/// where nothing is asked, empty. The rules are those of [`compare_profile`].
pub fn machine_csv(run: &BenchRun) -> String {
    table(&compare_profile(&run.target, &run.machine), &PROPERTY)
}

/// # Panics
/// Never: records are flat, and neither serialising them nor writing to memory can fail.
fn table<T: Serialize>(rows: &[T], header: &[&str]) -> String {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(header).expect("memory can be written to");
    for row in rows {
        writer.serialize(row).expect("a flat record has a line");
    }
    let bytes = writer.into_inner().expect("memory can be written to");
    String::from_utf8(bytes).expect("text was written")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::tests::mock_run;
    use isostudy_design::record::Counters;

    fn rows<T: serde::de::DeserializeOwned>(text: &str) -> Vec<T> {
        csv::Reader::from_reader(text.as_bytes()).deserialize().collect::<Result<_, _>>().unwrap()
    }

    #[test]
    fn samples_read_back_unchanged() {
        let run = mock_run();
        let text = samples_csv(&run.samples);
        let header = "id,invocation,iteration,place,allocation_s,sampling_s,vertex_s,geometry_s,clustering_s,normals_s,\
                      total_s,reference_s,cpu_s,page_faults,context_switches,instructions,cache_misses,\
                      branch_misses,energy_j,outside_s";
        assert_eq!(text.lines().next(), Some(header));
        // A file has no nesting: a row is read as a sample, and once more as what was counted.
        let mut samples = rows::<BenchSample>(&text);
        samples
            .iter_mut()
            .zip(rows::<Counters>(&text))
            .for_each(|(sample, counters)| sample.counters = counters);
        assert_eq!(samples, run.samples);
        assert!(samples.iter().any(|sample| sample.counters.page_faults.is_some()));
        assert_eq!(samples_csv(&[]), format!("{header}\n"), "no samples are no empty file");
    }

    #[test]
    fn finishing_is_a_column_of_all_where_one_is_finished() {
        let mut run = mock_run();
        let last = run.samples.len() - 1;
        run.samples[last].finishing_s = 0.25;
        let text = samples_csv(&run.samples);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].ends_with(",outside_s,finishing_s"));
        assert!(lines[1].ends_with(",0.0") && lines[1 + last].ends_with(",0.25"), "{text}");
        let mut samples = rows::<BenchSample>(&text);
        samples
            .iter_mut()
            .zip(rows::<Counters>(&text))
            .for_each(|(sample, counters)| sample.counters = counters);
        assert_eq!(samples, run.samples);
    }

    #[test]
    fn the_machine_is_told_property_by_property() {
        let mut run = mock_run();
        run.target.cores = Some(4);
        run.target.threads = Some(16);
        let text = machine_csv(&run);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "property,target,machine,matches");
        assert_eq!(lines[1], "model,,11th Gen Intel(R) Core(TM) i7-11700 @ 2.50GHz,");
        assert_eq!(lines[2], "cores,4,8,false");
        assert_eq!(lines[3], "threads,16,16,true");
        assert!(lines.contains(&"governor,,unknown,"), "{text}");
        assert!(lines.contains(&"compiler,,rustc 1.95.0,"), "{text}");
    }
}
