"""Why a target is missed, for as long as it is, with what a profile says."""

REASONS = """
## What is out of reach, and why

Shares are of processor time, by `perf record`, on a computer with AVX-512.

- **A linear twin for 5 % of a tick.** Of what it takes a third are its map, what numbers of
  the machine push, and carrying sensitivities over a block of 8 ticks (kernels that keep
  registers full), and a twelfth divides readings and sensitivities by their noise. The rest
  is the estimate, once a block: the information of 24 readings about 13 unknowns, its
  factors, how surprising the block is, rates of wear, and copies of what it says, in matrices
  too small for kernels. If the first third took no time at all, 5.7 % would be left. What
  remains is an estimate every 8 ticks: longer blocks would halve it, and see a change later.
  While it goes back to learn it makes two ticks in every one, and both weigh every reading by
  itself: blocks whose readings are averaged before took three fifths of that, and gave
  estimates up to a sixth above the bound that said they were surer than they were.
- **A nonlinear twin that learns for 1.5 bare ticks.** While it goes back it makes two ticks of
  the plant in every tick, which are two bare ticks, whatever else is done: 75 % of its time
  are in MuJoCo's steps, 17 % carry sensitivities over these, and 8 % are all else. It follows
  for 1.36 to 1.42; 1.5 leaves a tenth of a tick for what was missed, so it would hardly catch up.
- **Clips at 1.3 times bare render plus encode, and 60 a second.** A frame with its diagnosis
  takes 38 ms of processor time, a bare one 37 ms: of the clip 45 % are in the encoder (27 % in
  its quantisation alone), 25 % in OSMesa and what it compiles, 18 % in the system and in
  copies, and 3 % in OpenCV and in what mjdiag paints. Two cores of this speed make 53 of
  these frames a second if nothing ever waits; 60 take cores that are faster by 15 %, or a
  third one, or an encoder that compresses less. On two cores that were free clips had 33
  to 60 frames a second, 1.1 to 1.35 times bare ones, which fill 1.6 cores already: overlap
  is worth that, and no more. On a computer that is busy otherwise the ratio is that of
  processor time, 1.
"""
