"""The words of every figure and table: a figure's title, what is drawn with which marks, what kind of figure it is."""

from __future__ import annotations

from typing import NamedTuple


class Words(NamedTuple):
    """Of one figure: its title, what is drawn with which marks, and what kind of figure it is, for who sees none."""

    title: str
    shown: str
    alt: str


_INTERVALS = ("Error bars are 95 % intervals that include how trainings and configurations differ; a cell's training "
              "variance is moderated by that of all like cells.")
_MAPS = ("seen from above: a cell is one place of the object, its colour the number of seeds whose policy succeeds "
         "there; the robot's base is below the map, at x = 0, y = 0.")

_HANDS = ("anywhere in its range in training and evaluation (the maps; the authors' camera, target and 35 traced-back "
          "steps), within 3 cm of its place in training, or always in one place, so that static's demonstrations of a "
          "point are all alike (both: this package's earlier camera and target).")

FIGURES = {
    "claims": Words(
        "What became of the paper's claims",
        "The claims that are numbers, those of a figure together: ours with its 95 % interval, coloured by the verdict "
        "that one rule makes from stored runs, the paper's value a diamond. Of a claim of several things small strokes "
        "are the single ones and the point is their mean, or the trend over them.",
        "A forest plot with a line a claim: a point, its interval, and a diamond for the paper."),
    "equal_demonstrations": Words(
        "As many demonstrations instead of as many timesteps",
        f"Success on Pick-Place where both methods get as many timesteps, and where static gets as many demonstrations "
        f"as MOVE. {_INTERVALS} White dots are single seeds.",
        "Two groups of bars, static beside MOVE."),
    "few_demonstrations": Words(
        "How few demonstrations at a place are too few?",
        f"Success in figure 1's experiment against the budget, (a) at the nine grasp points of the demonstrations "
        f"themselves and (b) over the whole space. In these budgets static makes about 2, 5 and 9 demonstrations at "
        f"each point, MOVE a fifth fewer. {_INTERVALS} Question marks are budgets that are not computed yet.",
        "Two panels with a curve a method over the budget."),
    "fig1_sparse": Words(
        "Figure 1. Nine grasp points: success over the places between",
        f"(a, b) Static and MOVE, {_MAPS} Rings are the nine grasp points, filled with their own success. "
        f"(c) Success over the whole space by where the hand starts: {_HANDS} {_INTERVALS} White dots are single "
        f"seeds, dotted lines the paper's values.",
        "Two maps of a space of 30 by 30 cm, coloured by success, and a bar chart."),
    "fig2_overview": Words(
        "Figure 2. The idea: points against segments",
        "(a to f) Where the object, until it is grasped, and the target were at every timestep that each way of "
        "collecting recorded, seen from above; the rectangle is the range that evaluation draws from; the percentage "
        "is the share of a 10 x 10 grid's cells visited. ADC (adversarial data collection) makes object and target "
        "jump. (g to i) Frames of demonstrations in which one thing alone moves; the number is the timestep. The "
        "titles say how much faster than in the data sets.",
        "Six scatter plots of places and three strips of camera images of a robot arm."),
    "fig3_dense": Words(
        "Figure 3. Grasp points everywhere",
        f"(a, b) Static and MOVE, {_MAPS} Small dots are where the demonstrations of all seeds grasped. (c) Success "
        f"over the whole space by where the hand starts: {_HANDS} White dots are single seeds, dotted lines the "
        f"paper's values. (d) Success at smaller budgets, hands anywhere. {_INTERVALS}",
        "Two maps of a space of 30 by 30 cm, coloured by success, a bar chart and two curves over the budget."),
    "fig4_scaling": Words(
        "Figure 4. Success against the amount of data",
        f"Success of each method against the timesteps of demonstrations, one panel a task, at table 2's "
        f"configurations. {_INTERVALS} Diamonds are the paper's values at its own budgets (drawn a little to the "
        f"right), question marks budgets that are not computed yet.",
        "Ten small panels, one a task, each with a curve a method over the budget."),
    "fig4_efficiency": Words(
        "Figure 4, as one number: data efficiency",
        "How many times the timesteps static needs to succeed as often as MOVE does at table 2's budget, with 95 % "
        "intervals. A hollow point with an arrow says more than: static does not get there with the data it was given.",
        "One line a task with a point and an interval on a logarithmic axis of factors from a quarter to four."),
    "fig5_circle": Words(
        "Figure 5. Grasp points on a circle: inside and outside",
        f"(a, b) Static and MOVE, {_MAPS} Rings are the twenty grasp points on the dashed circle, filled with their "
        f"own success. (c, d) Success inside and outside of the circle by where the hand starts: {_HANDS} {_INTERVALS} "
        f"White dots are single seeds, dotted lines the paper's values.",
        "Two maps of a space of 30 by 30 cm with a circle, coloured by success, and a bar chart."),
    "fig6_dimensions": Words(
        "Figure 6. What has to move?",
        f"Success as one thing after the other moves in the demonstrations, and where one thing moves alone (light "
        f"bars); the first bar is static collection. {_INTERVALS} White dots are single seeds. The paper prints no "
        f"numbers for this figure.",
        "One bar chart a task, one bar for everything that moves."),
    "fig7_speed": Words(
        "Figure 7. How fast may it move?",
        f"Success against one largest speed, the others as everywhere else; the dashed line is static collection, "
        f"the band its interval. {_INTERVALS} Question marks are speeds that are not computed yet. The paper prints no "
        f"numbers for this figure.",
        "A grid of curves over the speed, one row a task, one column for the object, the target and the camera."),
    "fig8_object_places": Words(
        "Figure 8, continued. Where the object was, and how fast it moved",
        "(a, b) Where the orange was seen in the image up to its grasp, joined within a demonstration. (c) Its mean "
        "speed before the grasp, one dot a demonstration, spread sideways to be told apart. The orange is followed by "
        "its colour; what a still orange seems to move is the noise of that.",
        "Two maps of an image with dots and lines, and a strip of dots for the speeds."),
    "fig8_real_setup": Words(
        "Figure 8. The real-robot setup: workspace and demonstrations",
        "Left: the way of the end effector to each grasp (dots), seen from above on the half disc of 60 cm radius; the "
        "black square is the arm's base, y grows to the left as seen by the arm. Right: the cells of 5 cm that it "
        "passed through, up to as many timesteps for each method. Below: frames of one demonstration of each method, "
        "each at its own times; orange: the object, blue: the tray it is put on, black: the fingers.",
        "Half discs with trajectories and visited cells, and two strips of images from above."),
    "fig_mixture": Words(
        "How much of the data has to move?",
        f"Success on Pick-Place against the share of the timesteps that MOVE collected, the rest being static. "
        f"{_INTERVALS} White dots are single seeds.",
        "A bar chart over the share of moving demonstrations."),
    "fig_speed_law": Words(
        "Does it matter how speeds are drawn?",
        f"Success on Pick-Place: static, and MOVE with every speed drawn from Beta(2, 5) as in the paper, uniformly "
        f"between 0 and twice its mean, or always its mean. {_INTERVALS} White dots are single seeds. The paper gives "
        f"no numbers.",
        "A bar chart with a bar for static and one for each law of the speeds."),
    "fig_training_length": Words(
        "Does the comparison depend on how long one trains?",
        f"Success against the number of gradient steps, in multiples of the recipe's, one panel a task. {_INTERVALS} "
        f"Question marks are trainings that are not computed yet.",
        "One panel a task with a curve a method over the length of training."),
    "fig_coverage": Words(
        "Does success follow what the data cover?",
        f"Success from pixels against the share of equal cells that the data visit: (a) of the object's positions, (b) "
        f"of the camera's angles, (c) of both together. One mark a task and way to collect, triangles where parts of "
        f"MOVE move alone; grey lines join the marks of a task. {_INTERVALS}",
        "Three clouds of points in the methods' colours, joined task by task."),
    "fig_perception": Words(
        "What is left when perception is given",
        f"Success in figures 1, 3 and 5 and in table 1 away from the demonstrations' own grasp points, (a) from pixels "
        f"and (b) from keypoints. {_INTERVALS} White dots are single seeds.",
        "Two panels of bars, static beside MOVE in each experiment."),
    "gap": Words(
        "Why rates here are not the paper's, setting by setting",
        "Left: static's success from the package's protocol to the paper's value. Grey bars are what one setting of "
        "the authors' does when it alone is switched; the light one is what all of them together do more than their "
        "sum; what is left is not explained. Right: MOVE minus static under each setting; the diamond is the paper's. "
        "Error bars are 95 % intervals that include how trainings and configurations differ.",
        "One row a case: a waterfall of bars from a high rate to a low one, and points with intervals."),
    "generalization": Words(
        "Failing to learn, to generalise, or to follow?",
        f"Success of each policy at the grasps of its own demonstrations (hollow; fewer configurations than elsewhere, "
        f"fewest where a budget is small), at configurations that no training used (filled), and at the same with "
        f"everything in motion (triangles). {_INTERVALS}",
        "For each task and method three points joined by a line: its own grasps, elsewhere, in motion."),
    "keypoint_control": Words(
        "The keypoint control: what is left when perception is given",
        f"Success on Pick-Place from keypoints against the timesteps of demonstrations. {_INTERVALS} Diamonds are the "
        f"paper's values, from images, at its own budget: a reference, not a comparison. Dashed lines: the expert, and "
        f"an expert that is told a wrong goal.",
        "Three curves over the budget between a floor and a ceiling."),
    "rollouts": Words(
        "What success and failure look like",
        "Evaluation episodes drawn at random, for each method until one has succeeded and one has failed; red: the "
        "object, blue: the target. The number on a frame is its timestep. An episode ends ten steps after its first "
        "success, or after 200; one successful step makes it a success.",
        "Strips of camera images of a robot arm, one a shown episode."),
    "statistics": Words(
        "What can a success rate say?",
        "Simulated studies of 100 configurations. (a) How often nominal 95 % intervals hold the true rate: ours "
        "filled, those that count episodes alone hollow, one shape a number of seeds; the grey band is 93 to 97 %. "
        "(b) How wide ours are with one seed and with more, by how much trainings differ.",
        "A scatter plot of coverages around a band at 95 %, and three falling curves."),
    "table1_spatial_factors": Words(
        "Table 1. How much harder does every random factor make it?",
        f"(a) Success on Pick-Place as more is random: the object, then the target and the hand too, then the camera "
        f"too. White dots are single seeds, dotted lines the paper's static values. (b) MOVE minus static, paired by "
        f"configuration. {_INTERVALS}",
        "A bar chart of static beside MOVE in three groups, and their differences with intervals."),
    "table2_main": Words(
        "Table 2. Ten tasks: static, ADC and MOVE",
        f"(a) Success from pixels, (b) success from keypoints, where perception is given, each between the expert and "
        f"an expert that is told a wrong target. (c) MOVE minus the others from pixels, paired by configuration, and "
        f"the mean of the tasks. {_INTERVALS} Diamonds are the paper's values. Box-Close has 20,000 timesteps here and "
        f"100,000 in the paper.",
        "Two panels of points with intervals for ten tasks and three methods, and a panel of differences."),
    "table3_real": Words(
        "Table 3. The paper's real-robot trials, with what thirty trials leave open",
        "(a) Success of the paper's four cells, thirty trials each, with exact 95 % intervals. (b) The score "
        "(diamonds), a third for each of approach, pick-up and put-down, over the range (grey) in which it must lie "
        "once the successes are known. Counts are the paper's.",
        "A bar chart of four cells with intervals, and four diamonds over grey ranges."),
    "table6_collection": Words(
        "Table 6. What a demonstration costs",
        "(a) Timesteps of a successful demonstration and (b) share of attempts that succeed: means over the tasks with "
        "95 % intervals from the spread of the tasks (of a mean: Student's; of a share: Wilson's, with the number of "
        "trials that this spread is worth). Dots are single tasks, dotted lines the paper's values.",
        "Two bar charts, for each method one dark and one light bar."),
    "table_adc": Words(
        "Which ADC is the stronger baseline?",
        f"Success of ADC under three readings of when its objects jump, from pixels and from keypoints, where "
        f"perception is given. {_INTERVALS}",
        "Two panels of points with intervals for ten tasks and up to three readings."),
    "table_keypoint_control": Words(
        "Ten tasks from keypoints, between floor and ceiling",
        f"Success from keypoints, where perception is given, at the smaller budget; solid lines are the expert, dashed "
        f"lines an expert that is told a wrong goal. {_INTERVALS}",
        "Points with intervals for ten tasks and three methods."),
    "table_recipe": Words(
        "The laptop's recipe for images, and what each part of it is worth",
        "Static alone, one training a line, tried at configurations that its own demonstrations began with. Left of "
        "each pair: success; right: success minus the chosen recipe's, paired, with the minutes of training. Error "
        "bars are 95 % intervals that know about the episodes alone.",
        "Four panels of points with intervals, one line a change of the recipe."),
}

_RATES = "Success in per cent with 95 % intervals, which include how trainings and configurations differ."
_DIFFERENCES = ("MOVE minus another method in points, paired by configuration, with 95 % intervals; p after Holm's "
                "adjustment is over the rows of one comparison.")
_COSTS = "Minutes that a run takes, median, one core."

TABLES = {
    "claims": "The paper's claims, each with its verdict and the evidence.",
    "equal_demonstrations": f"Equal timesteps and equal demonstrations, Pick-Place. {_RATES}",
    "equal_demonstrations_differences": f"Equal timesteps and equal demonstrations. {_DIFFERENCES}",
    "equal_demonstrations_made": "Demonstrations in a data set, mean of the seeds.",
    "few_demonstrations": f"Figure 1 with fewer demonstrations: the whole space. {_RATES}",
    "few_demonstrations_points": f"Figure 1 with fewer demonstrations: at the nine grasp points themselves. {_RATES}",
    "few_demonstrations_differences": f"Figure 1 with fewer demonstrations: the whole space. {_DIFFERENCES}",
    "few_demonstrations_made": "Figure 1 with fewer demonstrations: how many there are, means of the seeds.",
    "fig1_sparse": f"Figure 1: nine grasp points, the whole space. {_RATES}",
    "fig1_sparse_points": f"Figure 1: at the nine grasp points themselves. {_RATES}",
    "fig1_sparse_difference": f"Figure 1: the whole space. {_DIFFERENCES}",
    "fig1_sparse_hand": f"Figure 1, by where the hand starts. {_RATES}",
    "fig1_sparse_length": f"Figure 1: static at its own configurations, by length of training. {_RATES}",
    "fig1_sparse_costs": f"Figure 1. {_COSTS}",
    "fig2_overview": "Figure 2: share of the cells of each range that the demonstrations visit, in per cent.",
    "fig3_dense": f"Figure 3: grasp points everywhere, the whole space. {_RATES}",
    "fig3_dense_difference": f"Figure 3: the whole space. {_DIFFERENCES}",
    "fig3_dense_budgets": f"Figure 3: smaller budgets. {_RATES}",
    "fig3_dense_budgets_difference": f"Figure 3: smaller budgets. {_DIFFERENCES}",
    "fig3_dense_hand": f"Figure 3, by where the hand starts. {_RATES}",
    "fig3_dense_near_budgets": f"Figure 3: smaller budgets, hands within 3 cm. {_RATES}",
    "fig3_dense_near_budgets_difference": f"Figure 3: smaller budgets, hands within 3 cm. {_DIFFERENCES}",
    "fig3_dense_costs": f"Figure 3. {_COSTS}",
    "fig4_scaling": f"Figure 4: success against the amount of data. {_RATES}",
    "fig4_scaling_efficiency": "Figure 4: static's timesteps over MOVE's for the success that MOVE has at table 2's "
                               "budget, with 95 % intervals, and the least and most that could have been found.",
    "fig4_scaling_equal": "Figure 4: MOVE minus static at the budgets that the paper calls equally good; in points, "
                          "with 95 % intervals.",
    "fig5_circle": f"Figure 5: inside and outside of the circle. {_RATES}",
    "fig5_circle_points": f"Figure 5: at the twenty grasp points themselves. {_RATES}",
    "fig5_circle_differences": f"Figure 5: inside and outside of the circle. {_DIFFERENCES}",
    "fig5_circle_hand": f"Figure 5, by where the hand starts. {_RATES}",
    "fig5_circle_costs": f"Figure 5. {_COSTS}",
    "fig6_dimensions": f"Figure 6: what has to move. {_RATES}",
    "fig6_dimensions_steps": "Figure 6: each motion added against the row before, and each alone against nothing; in "
                             "points, with 95 % intervals.",
    "fig7_speed": f"Figure 7: the largest speed of one thing. {_RATES}",
    "fig7_speed_ends": "Figure 7: each speed against the one used everywhere else; in points, with 95 % intervals.",
    "fig_mixture": f"Shares of MOVE in the data, Pick-Place. {_RATES}",
    "fig_mixture_gains": "Each share of MOVE against none; in points, with 95 % intervals.",
    "fig_speed_law": f"How speeds are drawn, Pick-Place. {_RATES}",
    "fig_speed_law_others": "Each other law of the speeds against Beta(2, 5); in points, with 95 % intervals.",
    "fig_training_length": f"Length of training. {_RATES}",
    "fig_training_length_depends": "MOVE minus static at the longest training, minus the same at the shortest; in "
                                   "points, with 95 % intervals.",
    "fig_training_length_beyond": "MOVE minus static at the longest training, minus the same at the recipe's own "
                                  "length; in points, with 95 % intervals.",
    "fig_training_length_differences": f"At each length of training. {_DIFFERENCES}",
    "fig_coverage": f"Success, and shares of cells that the data visit in their first timesteps. {_RATES}",
    "fig_perception": f"Figures 1, 3 and 5 and table 1, from pixels and from keypoints. {_RATES}",
    "fig_perception_differences_rgb": f"Figures 1, 3 and 5 and table 1, from pixels. {_DIFFERENCES}",
    "fig_perception_differences_keypoints": "Figures 1, 3 and 5 and table 1, from keypoints, perception given. "
                                            f"{_DIFFERENCES}",
    "gap": f"Success under each setting, and what switching it alone does, in points. {_RATES}",
    "gap_steps": "The steps from the package's rate to the paper's, each with the interval of its length.",
    "gap_leads": f"MOVE minus static under each setting. {_DIFFERENCES}",
    "generalization": "Success in per cent at a policy's own grasps, elsewhere, and elsewhere in motion; what is lost "
                      "from own grasps to elsewhere in points.",
    "generalization_rates": f"The same with intervals. {_RATES}",
    "generalization_differences": f"In motion. {_DIFFERENCES}",
    "keypoint_control": f"From keypoints: Pick-Place, perception given. {_RATES}",
    "keypoint_control_differences": f"From keypoints: Pick-Place, perception given. {_DIFFERENCES}",
    "keypoint_control_differences_mean": f"From keypoints: Pick-Place, mean of the budgets. {_DIFFERENCES}",
    "rollouts": "The episodes shown, how they ended here and in the evaluation.",
    "statistics": "Simulated studies: share in per cent of nominal 95 % intervals that hold the true rate, and half "
                  "their width in points.",
    "table1_spatial_factors": f"Table 1: what is random, Pick-Place. {_RATES}",
    "table1_spatial_factors_differences": f"Table 1: what is random. {_DIFFERENCES}",
    "table1_spatial_factors_lost": "Table 1: static with more random against static with the object alone, not "
                                   "paired; in points, with 95 % intervals.",
    "table1_spatial_factors_costs": f"Table 1. {_COSTS}",
    "table2_main": "Table 2: success in per cent from pixels with 95 % intervals, the paper's beside it, the expert "
                   "(ceiling) and an expert that is told a wrong target (floor).",
    "table2_main_keypoints": f"Table 2 from keypoints, perception given. {_RATES}",
    "table2_main_differences": f"Table 2 from pixels. {_DIFFERENCES}",
    "table2_main_differences_mean": f"Table 2 from pixels, mean of the tasks. {_DIFFERENCES}",
    "table2_main_differences_keypoints": f"Table 2 from keypoints. {_DIFFERENCES}",
    "table2_main_differences_keypoints_mean": f"Table 2 from keypoints, mean of the tasks. {_DIFFERENCES}",
    "table2_main_over_tasks": "Table 2 from pixels with the task as the unit: means and interquartile means in points "
                              "and per cent, and the probability that MOVE is better on a task, in per cent.",
    "table2_main_over_tasks_keypoints": "Table 2 from keypoints with the task as the unit, as above.",
    "table2_main_costs": f"Table 2 from pixels. {_COSTS}",
    "table3_real": "Table 3: the paper's real-robot trials; exact 95 % intervals, and the scores that the successes "
                   "alone would allow.",
    "table3_real_checks": "What was checked in the real-robot demonstrations.",
    "table4_hyperparameters": "Table 4: hyperparameters, ours beside the paper's.",
    "table5_data_sizes": "Table 5: timesteps of each task, and how many demonstrations they are.",
    "table6_collection": "Table 6: what a demonstration costs, means over the tasks.",
    "table6_collection_by_task": "Table 6, task by task; 95 % intervals are Wilson's.",
    "table6_collection_kept": "Share of random configurations that a task's reach and clearance filter keeps.",
    "table_adc": f"Three readings of ADC. {_RATES}",
    "table_adc_means": "Three readings of ADC: means over the tasks.",
    "table_adc_differences": "Readings of ADC minus the one as printed, means over the tasks that have both; in "
                             "points, with 95 % intervals.",
    "table_keypoint_control": "From keypoints, perception given: success in per cent with 95 % intervals, the expert "
                              "(ceiling) and an expert that is told a wrong goal (floor).",
    "table_keypoint_control_differences": f"From keypoints. {_DIFFERENCES}",
    "table_keypoint_control_differences_mean": f"From keypoints, mean of the tasks. {_DIFFERENCES}",
    "table_keypoint_control_over_tasks": "From keypoints with the task as the unit: means and interquartile means in "
                                         "points and per cent, and the probability that MOVE is better on a task, in "
                                         "per cent.",
    "table_keypoint_control_larger": f"From keypoints, perception given, at the larger budget. {_RATES}",
    "table_recipe": "The recipe for images with one change at a time: minutes and loss of training, success in per "
                    "cent at its own configurations, and the gain over the chosen recipe in points.",
}
