//! Whose row it is, where a row is a participant: one person under two ids, and rows that are there twice.

use crate::address;
use crate::choice::Choice;
use crate::decode::records::{Record, trim};
use crate::error::{Fault, number_of, shorten};
use crate::formats::layout::Layout;
use crate::mapping::{Duplicates, Mapping};
use crate::report::{Kind, Report};
use std::collections::HashMap;

/// Who has answered so far.
#[derive(Debug, Default)]
pub(crate) struct People {
    /// The row of each participant whose id is in the file.
    ids: HashMap<String, u64>,
    /// The row and the id of each e-mail address.
    addresses: HashMap<String, (u64, String)>,
    /// The row of each time with its answers.
    sheets: HashMap<String, u64>,
}

impl People {
    /// The id of a row's participant: an earlier one's, where the row has that one's e-mail address. Also whether it is
    /// an earlier one's.
    ///
    /// # Errors
    /// A known id or address, unless it is declared which row counts.
    pub(crate) fn id(
        &mut self,
        record: &Record<'_>,
        layout: &Layout,
        own: String,
        mapping: &Mapping,
        report: &mut Report,
    ) -> Result<(String, bool), Fault> {
        let (row, refuse) = (record.row, mapping.duplicates == Duplicates::Refuse);
        let first = match layout.participant {
            Some(_) => *self.ids.entry(own.clone()).or_insert(row),
            None => row,
        };
        if first != row && refuse {
            return Err(Fault::DuplicateParticipant { row, first, participant: shorten(&own) });
        }
        // A declared column says who is who; colleagues may share an address.
        if mapping.participant_column.is_some() {
            return Ok((own, first != row));
        }
        let cells = layout.addresses.iter().map(|&column| record.cell(column));
        let addresses: Vec<String> = cells.filter_map(address::folded).collect();
        let known = addresses.iter().find_map(|address| self.addresses.get(address)).cloned();
        let (id, again) = match known {
            Some((first, _)) if refuse => return Err(Fault::DuplicateAddress { row, first }),
            // Somebody known by the id already is not somebody else by the address.
            Some((of, id)) if first == row => {
                report.row(
                    Kind::Noted,
                    row,
                    format!("the e-mail address of row {of}: taken for the same person"),
                );
                (id, true)
            }
            _ => (own, first != row),
        };
        for address in addresses {
            self.addresses.entry(address).or_insert_with(|| (row, id.clone()));
        }
        Ok((id, again))
    }

    /// Notes a row that was started at the same time as another and has all the same answers.
    pub(crate) fn sheet(
        &mut self,
        record: &Record<'_>,
        layout: &Layout,
        choices: &[Option<Choice>],
        report: &mut Report,
    ) {
        /// Fewer answers are the same by chance.
        const FEWEST: usize = 3;
        let time = layout.time.map_or("", |column| trim(record.cell(column)));
        let given = choices.iter().flatten().count();
        if time.is_empty() || given < FEWEST {
            return;
        }
        let codes = choices.iter().map(|choice| choice.map_or('-', |choice| char::from(choice as u8 + b'0')));
        let sheet: String = codes.chain(time.chars()).collect();
        let row = record.row;
        let first = *self.sheets.entry(sheet).or_insert(row);
        if first != row {
            let action = format!(
                "the same time and the same {} as row {first}: perhaps a copy; both are counted",
                number_of(given, "answer")
            );
            report.row(Kind::Noted, row, action);
        }
    }
}
