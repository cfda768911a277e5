//! E-mail addresses: they tell that two rows are one person's, and are neither shown nor kept.

use crate::decode::records::{is_blank, trim};
use crate::words::normalise;

/// Headers of columns with the e-mail address of whoever answered, as forms and people call them.
const TITLES: [&str; 26] = [
    "email",
    "e-mail",
    "mail",
    "email address",
    "e-mail address",
    "your email",
    "your email address",
    "username",
    "emailaddress",
    "recipientemail",
    "recipient email",
    "e-mail-adresse",
    "nutzername",
    "adresse e-mail",
    "adresse de messagerie",
    "nom d'utilisateur",
    "correo electrónico",
    "dirección de correo electrónico",
    "nombre de usuario",
    "e-mailadres",
    "gebruikersnaam",
    "posta elettronica",
    "indirizzo email",
    "nome utente",
    "endereço de e-mail",
    "nome de usuário",
];

/// Whether a column under this header has the address of whoever answered.
pub(crate) fn is_title(title: &str) -> bool {
    TITLES.contains(&normalise(title).as_str())
}

/// Whether a cell is one address: `name@host.domain`. What forms write for nobody, such as `anonymous`, is none.
pub(crate) fn is_address(cell: &str) -> bool {
    /// The longest that mail knows has 254 bytes; space may stand round it.
    const LONGEST: usize = 300;
    if cell.len() > LONGEST {
        return false;
    }
    let Some((name, host)) = trim(cell).split_once('@') else { return false };
    let Some((host, domain)) = host.rsplit_once('.') else { return false };
    let space = |part: &str| part.contains(|c: char| c.is_whitespace() || c.is_control());
    !space(name)
        && !space(host)
        && !is_blank(name)
        && !host.is_empty()
        && !domain.is_empty()
        && domain.chars().all(char::is_alphabetic)
}

/// An address as it is compared: case does not matter.
pub(crate) fn folded(cell: &str) -> Option<String> {
    is_address(cell).then(|| trim(cell).to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_told_from_what_stands_for_none() {
        for cell in ["a@x.org", " Ann.B+study@mail.example.co.uk ", "a@b.c", "jörg@müller.de", "'a'@x.org"]
        {
            assert!(is_address(cell), "{cell}");
        }
        for cell in [
            "",
            "anonymous",
            "anonym",
            "a@",
            "@x.org",
            "a@x",
            "a@.org",
            "a@x.",
            "a b@x.org",
            "blur@2.0",
            "a@x.org, b@x.org",
        ] {
            assert!(!is_address(cell), "{cell}");
        }
        assert!(!is_address(&format!("{}@x.org", "a".repeat(1 << 20))));
        assert_eq!(folded(" A@X.org"), folded("a@x.ORG "));
        assert_eq!(folded("anonymous"), None);
    }

    #[test]
    fn titles_are_written_as_they_are_compared() {
        for title in TITLES {
            assert_eq!(normalise(title), title);
        }
        assert!(is_title("E-Mail-Adresse *") && !is_title("Which of the two?"));
    }
}
