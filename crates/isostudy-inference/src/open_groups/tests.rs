use super::*;
use isostudy_responses::{Answer, Choice, Participant, Question};

/// One participant who takes the left item of every question `(id, object, group, left, right)`.
fn answered(questions: &[(&str, &str, &str, u32, u32)]) -> Responses {
    let question = |&(id, object, group, left, right): &(&str, &str, &str, u32, u32)| {
        Question::new(id, object, group, [left, right])
    };
    let answer = |(question, &(_, _, _, left, right)): (usize, &(&str, &str, &str, u32, u32))| {
        Answer::new(0, question as u32, [left, right], Choice::Left)
    };
    Responses {
        participants: vec![Participant { id: "p".into(), form: None }],
        questions: questions.iter().map(question).collect(),
        items: "abcdefgh".chars().map(String::from).collect(),
        answers: questions.iter().enumerate().map(answer).collect(),
        sides_recorded: true,
        ..Responses::default()
    }
}

fn names(questions: &[(&str, &str, &str, u32, u32)]) -> Vec<String> {
    open_groups(&answered(questions), None).into_iter().map(|group| group.name).collect()
}

#[test]
fn groups_are_named_or_follow_from_who_met_whom() {
    // Joined through b, whatever the object; the control does not join d.
    assert_eq!(names(&[("1", "x", "", 0, 1), ("2", "y", "", 2, 1), ("c", "", "", 3, 3)]), ["all"]);
    // Items that never met are on scales of their own, named by their object where that tells them apart.
    let apart = [("1", "cube", "", 0, 1), ("2", "torus", "", 2, 3), ("3", "torus", "", 3, 4)];
    assert_eq!(names(&apart), ["cube", "torus"]);
    assert_eq!(names(&[("1", "cube", "", 0, 1), ("2", "cube", "", 2, 3)]), ["1", "2"]);
    // A named group is kept, and does not join what is not named.
    assert_eq!(names(&[("1", "", "g", 0, 1), ("2", "", "", 1, 2), ("3", "", "g", 2, 0)]), ["all", "g"]);
}

#[test]
fn ballots_count_the_items_of_their_group() {
    let groups =
        open_groups(&answered(&[("1", "", "", 4, 5), ("2", "", "", 1, 0), ("3", "", "", 5, 4)]), None);
    let items: Vec<String> = groups.iter().map(|group| group.items.join("")).collect();
    assert_eq!(items, ["ab", "ef"]);
    let shown = |group: &BallotGroup| {
        group.ballots.iter().map(|b| (b.question(), b.left(), b.right())).collect::<Vec<_>>()
    };
    assert_eq!(shown(&groups[0]), [(1, 1, 0)]);
    assert_eq!(shown(&groups[1]), [(0, 0, 1), (2, 1, 0)]);
}

#[test]
fn the_order_of_rows_changes_nothing_and_the_reference_is_named() {
    let straight = answered(&[("1", "", "", 4, 5), ("2", "", "", 5, 1), ("3", "", "", 1, 4)]);
    let mut reversed = straight.clone();
    reversed.answers.reverse();
    let items = |answers: &Responses, reference| open_groups(answers, reference)[0].items.join("");
    assert_eq!((items(&straight, None), items(&reversed, None)), ("bef".into(), "bef".into()));
    assert_eq!(items(&reversed, Some("f")), "fbe");
}
