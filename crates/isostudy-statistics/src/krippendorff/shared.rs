//! How many independent things the questions' shares are, over participants who answer several.

use super::Metric;
use crate::ballot::DeclaredBallot;

/// Trace squared over trace of the square of the covariance of the questions' shares: as many as coordinates if all vary alike and none
/// goes with another, 1 if one participant's answers to all questions say the same. `ballots` are sorted by participant.
///
/// Coordinates are, of each question with two answers or more, the mean of first less second and, if nominal, the share of
/// neither times sqrt 3, its distance from the mean over all answers: their squares add up to the agreement that is beyond chance.
/// `None` for fewer than four participants, or if all of them answer alike.
pub(super) fn degrees(ballots: &[DeclaredBallot], counts: &[[u64; 3]], metric: Metric) -> Option<f64> {
    let questions: Vec<Question> = counts.iter().map(Question::of).collect();
    let products = products(ballots, questions.len());
    let covariance = Covariance::of(&questions, &products, metric);
    let mut lengths: Vec<f64> = ballots
        .chunk_by(|a, b| a.participant() == b.participant())
        .map(|own| length(own, &questions, metric))
        .collect();
    // Sums of doubles depend on their order, and people come in any.
    lengths.sort_by(f64::total_cmp);
    let m = lengths.len() as f64;
    let trace = covariance.trace();
    if m < 4.0 || trace <= 0.0 {
        return None;
    }
    let fourth: f64 = lengths.iter().map(|length| length * length).sum();
    let square = (m - 1.0) * (m - 2.0) * covariance.square() + trace * trace - m * (m - 1.0) * fourth;
    let degrees = trace * trace * m * (m - 2.0) * (m - 3.0) / ((m - 1.0) * square);
    let most = questions.iter().filter(|q| q.counts()).count() as f64 * covariance.kinds as f64;
    // An unbiased estimate of a square may be next to nothing, or less.
    Some(if square > 0.0 { degrees.clamp(1.0, most.max(1.0)) } else { most.max(1.0) })
}

/// The means of a question's coordinates.
struct Question {
    answers: f64,
    /// Of first less second, and of neither.
    means: [f64; 2],
}

impl Question {
    fn of(counts: &[u64; 3]) -> Self {
        let [first, neither, second] = counts.map(|count| count as f64);
        let answers = first + neither + second;
        Self { answers, means: [(first - second) / answers, neither / answers] }
    }

    fn counts(&self) -> bool {
        self.answers >= 2.0
    }
}

/// What an answer adds to the sums of a question, first less second and neither.
fn terms(ballot: &DeclaredBallot) -> [i64; 2] {
    let sign = ballot.preference().sign();
    [sign, 1 - sign * sign]
}

/// For each two questions, over all two answers that one participant gave to them, the sums of the products of their [`terms`] and
/// of one: whole numbers, so that people come in any order.
fn products(ballots: &[DeclaredBallot], questions: usize) -> Vec<[[i64; 3]; 3]> {
    let mut together = vec![[[0; 3]; 3]; questions * questions];
    for own in ballots.chunk_by(|a, b| a.participant() == b.participant()) {
        for a in own {
            for b in own {
                together[a.question() * questions + b.question()][a.preference().index()]
                    [b.preference().index()] += 1;
            }
        }
    }
    for of in &mut together {
        let [[a, b, c], [d, e, f], [g, h, i]] = *of;
        *of = [
            [a - c - g + i, b - h, a + b + c - g - h - i],
            [d - f, e, d + e + f],
            [a + d + g - c - f - i, b + e + h, a + b + c + d + e + f + g + h + i],
        ];
    }
    together
}

/// What a difference and a share of neither count.
const LENGTHS: [f64; 2] = [1.0, 1.732_050_807_568_877_2];

/// The covariance of all coordinates but for a factor.
struct Covariance {
    kinds: usize,
    size: usize,
    values: Vec<f64>,
}

impl Covariance {
    fn of(questions: &[Question], products: &[[[i64; 3]; 3]], metric: Metric) -> Self {
        let kinds = kinds(metric);
        let size = kinds * questions.len();
        let mut values = vec![0.0; size * size];
        for (i, one) in questions.iter().enumerate().filter(|(_, q)| q.counts()) {
            for (j, other) in questions.iter().enumerate().filter(|(_, q)| q.counts()) {
                let sums = products[i * questions.len() + j].map(|row| row.map(|sum| sum as f64));
                for k in 0..kinds {
                    for l in 0..kinds {
                        let [mean, other_mean] = [one.means[k], other.means[l]];
                        let sum = sums[k][l] - other_mean * sums[k][2] - mean * sums[2][l]
                            + mean * other_mean * sums[2][2];
                        values[(kinds * i + k) * size + kinds * j + l] =
                            LENGTHS[k] * LENGTHS[l] * sum / (one.answers * other.answers).sqrt();
                    }
                }
            }
        }
        let mut covariance = Self { kinds, size, values };
        if metric == Metric::Nominal {
            covariance.take_off_the_mean(&weights(questions));
        }
        covariance
    }

    /// Of the shares of neither, from both sides.
    fn take_off_the_mean(&mut self, weights: &[f64]) {
        let Self { kinds, size, .. } = *self;
        (0..size).for_each(|row| self.take_off(weights, |q| row * size + kinds * q + 1));
        (0..size).for_each(|column| self.take_off(weights, |q| (kinds * q + 1) * size + column));
    }

    fn take_off(&mut self, weights: &[f64], place: impl Fn(usize) -> usize) {
        let mean: f64 = weights.iter().enumerate().map(|(q, w)| w * self.values[place(q)]).sum();
        weights.iter().enumerate().for_each(|(q, w)| self.values[place(q)] -= w * mean);
    }

    fn trace(&self) -> f64 {
        (0..self.size).map(|i| self.values[i * self.size + i]).sum()
    }

    /// Trace of its square.
    fn square(&self) -> f64 {
        self.values.iter().map(|value| value * value).sum()
    }
}

fn kinds(metric: Metric) -> usize {
    match metric {
        Metric::Nominal => 2,
        // How far apart values are says everything of the middle one.
        Metric::Ordinal => 1,
    }
}

/// Roots of the shares that questions have of all answers that count.
fn weights(questions: &[Question]) -> Vec<f64> {
    let answers = |q: &Question| if q.counts() { q.answers } else { 0.0 };
    let all: f64 = questions.iter().map(answers).sum();
    questions.iter().map(|q| (answers(q) / all).sqrt()).collect()
}

/// How far a participant's answers move the coordinates: the square, on the scale of [`Covariance`].
fn length(own: &[DeclaredBallot], questions: &[Question], metric: Metric) -> f64 {
    let all: f64 = questions.iter().filter(|q| q.counts()).map(|q| q.answers).sum();
    let (mut square, mut of_mean) = (0.0, 0.0);
    for of_question in own.chunk_by(|a, b| a.question() == b.question()) {
        let question = &questions[of_question[0].question()];
        if !question.counts() {
            continue;
        }
        for (k, length) in LENGTHS.iter().enumerate().take(kinds(metric)) {
            let sum: i64 = of_question.iter().map(|b| terms(b)[k]).sum();
            let moved = length * (sum as f64 - of_question.len() as f64 * question.means[k]);
            square += moved * moved / question.answers;
            of_mean += if k == 1 { moved } else { 0.0 };
        }
    }
    square - of_mean * of_mean / all
}
