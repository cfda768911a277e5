//! Days of the calendar, as study files and answers write them.

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::str::FromStr;

/// A day of the Gregorian calendar, written `YYYY-MM-DD`; earlier days are smaller. The year has four digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Date {
    year: u16,
    month: u8,
    day: u8,
}

/// Why a text is not a date.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not a date: write year, month and day with four, two and two digits, as in 2026-11-21")]
pub struct ParseDateError(String);

impl Date {
    /// The day with this year, month (1 to 12) and day of the month; `None` if the calendar has no such day.
    pub fn new(year: u16, month: u8, day: u8) -> Option<Self> {
        let leaps = year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
        let days = match month {
            2 => 28 + u8::from(leaps),
            4 | 6 | 9 | 11 => 30,
            1..=12 => 31,
            _ => 0,
        };
        (year <= 9999 && (1..=days).contains(&day)).then_some(Self { year, month, day })
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

impl FromStr for Date {
    type Err = ParseDateError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let shape =
            |(i, byte): (usize, u8)| if i == 4 || i == 7 { byte == b'-' } else { byte.is_ascii_digit() };
        let date = (text.len() == 10 && text.bytes().enumerate().all(shape)).then(|| {
            // Digits alone, few enough to fit.
            let number = |range: std::ops::Range<usize>| text[range].parse::<u16>().ok();
            Self::new(number(0..4)?, number(5..7)? as u8, number(8..10)? as u8)
        });
        date.flatten().ok_or_else(|| ParseDateError(text.into()))
    }
}

impl Serialize for Date {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// From a text, or from a local date of TOML, without quotes.
impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Written;
        impl<'de> Visitor<'de> for Written {
            type Value = Date;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a date such as 2026-11-21")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Date, E> {
                text.parse().map_err(E::custom)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Date, A::Error> {
                // A time of day beside it is refused with the rest.
                let written = toml::value::Datetime::deserialize(MapAccessDeserializer::new(map))?;
                written.to_string().parse().map_err(A::Error::custom)
            }
        }
        deserializer.deserialize_any(Written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize, Serialize, PartialEq)]
    struct Holder {
        day: Date,
    }

    fn read(value: &str) -> Result<Date, String> {
        let read = toml::from_str::<Holder>(&format!("day = {value}"));
        read.map(|holder| holder.day).map_err(|error| error.to_string())
    }

    #[test]
    fn dates_are_read_with_and_without_quotes() {
        let day = Date::new(2024, 2, 29).unwrap();
        assert_eq!((read("2024-02-29"), read("\"2024-02-29\"")), (Ok(day), Ok(day)));
        assert_eq!(serde_json::to_string(&Holder { day }).unwrap(), r#"{"day":"2024-02-29"}"#);
        assert_eq!(serde_json::from_str::<Holder>(r#"{"day":"2024-02-29"}"#).unwrap(), Holder { day });
    }

    #[test]
    fn anything_else_is_refused() {
        for text in [
            "",
            "2026",
            "2026-1-2",
            "26-11-21",
            "2026-11-21 ",
            "2026/11/21",
            "2026-00-10",
            "2026-13-01",
            "2026-02-29",
            "1900-02-29",
            "2026-04-31",
            "2026-01-00",
            "+026-01-01",
            "2026-11-21T10:00:00",
            "２026-1-01",
            "21.11.2026",
        ] {
            assert_eq!(text.parse::<Date>().unwrap_err(), ParseDateError(text.into()));
            let told = read(&format!("\"{text}\"")).unwrap_err();
            assert!(told.contains(&format!("\"{text}\"")), "{told}");
        }
        let timed = read("2026-11-21T10:00:00Z").unwrap_err();
        assert!(timed.contains("\"2026-11-21T10:00:00Z\""), "{timed}");
        for value in ["20261121", "true", "[2026, 11, 21]", "{ year = 2026 }"] {
            assert!(read(value).unwrap_err().contains("line 1"), "{value}");
        }
    }

    #[test]
    fn earlier_days_are_smaller() {
        let days = ["0001-12-31", "2025-12-31", "2026-01-01", "2026-01-31", "2026-02-01", "9999-12-31"];
        let days: Vec<Date> = days.iter().map(|day| day.parse().unwrap()).collect();
        assert!(days.is_sorted_by(|a, b| a < b));
        assert_eq!(days[0].to_string(), "0001-12-31");
    }
}
